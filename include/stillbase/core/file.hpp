// Whole text files in and out. A file that we write appears whole or not at all.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace stillbase {

/// Largest robot, problem or plan text that is read unless a reader says otherwise.
inline constexpr std::size_t kMaxInputBytes = 64u << 20;

/// Content of a file, byte for byte.
/// @param path as the user named it
/// @param max_bytes a longer file is refused before it is read into memory
/// @throws InputError (rules "missing-file", "not-a-file", "too-large")
/// @throws FileError when the system refuses to open or read it
std::string read_text_file(const std::string& path, std::size_t max_bytes = kMaxInputBytes);

/// Position of the first byte of a text that is not valid UTF-8 (RFC 3629) or a control character
/// other than line feed, carriage return and tab; npos when there is none.
std::size_t first_bad_byte(std::string_view text);

/// Writes a file: temporary file in the same folder, flush to the disk, then rename.
/// Guarantees: readers see the old content or the new one, never a part; after an error the old
/// content is untouched and no temporary file is left. Temporary files of processes that were
/// killed in writing this file block nothing and are removed. A path that names anything but a
/// regular file (device, folder, pipe) is refused.
/// @param overwrite false: an existing file is an error, also when it appears meanwhile
/// @throws FileError
void write_file_atomically(const std::string& path, std::string_view text, bool overwrite);

}  // namespace stillbase
