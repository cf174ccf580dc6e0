// COLLADA and glTF files, by Assimp.
//
// Assimp 5.2 follows broken files of these formats beyond the end of its memory, and some of them
// without end. It therefore reads in a child of this process, which has limits of memory and time;
// what it returns is looked at here before it is used.
//
// The child is forked from a process that may have other threads (a Python interpreter, a program
// that uses the library). In such a child only the forking thread lives on, and a lock that another
// one held stays held. The child allocates, which glibc, musl and macOS allow after a fork (the
// allocators of sanitizers do not, beside busy threads); throws and catches; reads files; and runs
// Assimp, which takes no lock that another user of it holds for long. It starts no thread, logs
// nothing, runs no handler at its end and never returns into the caller's code. Should it wait for
// a held lock all the same, its time limit ends it: then a good file is refused, and the caller
// goes on.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "robot/mesh_file.hpp"

namespace stillbase {

/// Processor time that Assimp may take for a file, s. A MiB takes it 0.01 s.
inline constexpr double kSceneSeconds = 0.8, kSceneSecondsPerMiB = 0.25;
/// Wall clock, of a machine that is busy with other things or was stopped, over that time.
inline constexpr double kSceneSlowness = 10;
/// Memory that it may take: so many bytes, and so many for each of the file. Seven are usual.
inline constexpr std::uintmax_t kSceneMemory = std::uintmax_t{512} << 20, kSceneMemoryPerByte = 16;

/// Reads a COLLADA or glTF file as one mesh, and what it names beside itself, in its own folder
/// alone.
/// @param path without symbolic links
/// @throws std::runtime_error what is wrong with it; MeshLimitError; FileError without a process
Mesh read_scene(const std::string& path);

/// What the child returns, and what is made of it: coordinates in single precision.
std::string mesh_to_bytes(const Mesh& mesh);
/// @throws std::runtime_error what is wrong with the mesh, or the bytes are not those of one
Mesh mesh_of_bytes(std::string_view bytes);

}  // namespace stillbase
