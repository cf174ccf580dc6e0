// Robots of problems/robots/.
#pragma once

#include <string>

#include <stillbase/core/file.hpp>
#include <stillbase/robot/urdf_reader.hpp>

namespace stillbase::test {

inline RobotModel shipped_robot(const std::string& name) {
  const std::string path = std::string(STILLBASE_SOURCE_DIR) + "/problems/robots/" + name + ".urdf";
  return read_urdf(read_text_file(path), path, "");
}

}  // namespace stillbase::test
