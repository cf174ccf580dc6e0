"""Conan 2 recipe: conan create packaging/conan --build=missing"""

from pathlib import Path

from conan import ConanFile
from conan.tools.cmake import CMake, CMakeToolchain, cmake_layout
from conan.tools.files import copy


class Stillbase(ConanFile):
    name = "stillbase"
    version = "0.1.0"
    license = "BSD-3-Clause"
    description = "Plans the pre-impact configuration of a free-floating space robot and proves that it works"
    package_type = "static-library"
    settings = "os", "compiler", "build_type", "arch"
    generators = "CMakeDeps"
    requires = (
        "eigen/3.4.0",
        "boost/1.83.0",
        "nlopt/2.7.1",
        "coin-ipopt/3.14.13",
        "fcl/0.7.0",
        "tinyxml2/10.0.0",
        "yaml-cpp/0.8.0",
        "assimp/5.4.3",
        "qhull/8.0.2",
        "nlohmann_json/3.11.3",
        "cli11/2.4.2",
        "fmt/10.2.1",
        "openssl/[>=3 <4]",
    )

    def export_sources(self):
        root = Path(self.recipe_folder).parent.parent
        for pattern in ("CMakeLists.txt", "README.md", "CHANGELOG.md", "LICENSE", "cmake/*", "include/*",
                        "src/*", "web/dist/*", "problems/*", "bench/suite.yaml", "bench/best_known.json",
                        "docs/*", "examples/*", "packaging/*.pc.in"):
            copy(self, pattern, root, self.export_sources_folder)

    def system_requirements(self):
        # OMPL has no recipe in the public index.
        from conan.tools.system.package_manager import Apt

        Apt(self).install(["libompl-dev"])

    def layout(self):
        cmake_layout(self)

    def generate(self):
        toolchain = CMakeToolchain(self)
        toolchain.cache_variables["STILLBASE_BUILD_TESTS"] = False
        toolchain.cache_variables["STILLBASE_BUILD_EXAMPLES"] = False
        toolchain.generate()

    def build(self):
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def package(self):
        CMake(self).install()

    def package_info(self):
        self.cpp_info.set_property("cmake_find_mode", "none")
        self.cpp_info.builddirs.append("lib/cmake/stillbase")
