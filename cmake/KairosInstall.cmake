# Installs the library, its headers, the program and a CMake package: find_package(kairos) then gives kairos::kairos.
