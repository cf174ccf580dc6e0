// Stands for the test programs when their precompiled headers are made: tests/CMakeLists.txt.
