#include <cstddef>
#include <cstdint>

#include "tests/fuzz/targets.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  rebake::fuzz::read_volume_bytes({reinterpret_cast<const char*>(data), size});
  return 0;
}
