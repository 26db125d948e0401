# Third-party libraries. Each is included by one room of the house only (docs/architecture.md).

find_package(Threads REQUIRED)
find_package(TBB REQUIRED)
find_package(embree 3.13 REQUIRED)
find_package(OpenEXR 3.1 REQUIRED)
find_package(nlohmann_json 3.11 REQUIRED)
find_package(fmt REQUIRED)
find_package(CLI11 REQUIRED)
find_package(draco REQUIRED)
find_package(meshoptimizer REQUIRED)
find_package(hwy REQUIRED)
find_package(ZLIB REQUIRED)

find_path(STB_INCLUDE_DIR stb/stb_image_write.h REQUIRED)
