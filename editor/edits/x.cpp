namespace rebake {}
