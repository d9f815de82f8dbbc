#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace rebake {

/// Scene folders and files that a script reads (imports, pictures of light, cage meshes), with variables filled in, in
/// the order of its lines. Lines that run_script() would refuse are left out.
std::vector<std::filesystem::path> script_inputs(std::string_view text,
                                                 const std::map<std::string, std::string>& variables);

}  // namespace rebake
