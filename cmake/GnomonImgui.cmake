# imgui::imgui, with its backends: Debian's package has no CMake file. Where it is absent there is no such target.
find_path(IMGUI_INCLUDE_DIR imgui.h PATH_SUFFIXES imgui)
find_library(IMGUI_LIBRARY imgui)
find_library(STB_LIBRARY stb) # Debian's imgui takes stb_truetype from there
if(IMGUI_INCLUDE_DIR AND IMGUI_LIBRARY AND STB_LIBRARY AND NOT TARGET imgui::imgui)
    add_library(imgui::imgui INTERFACE IMPORTED GLOBAL)
    target_include_directories(imgui::imgui SYSTEM INTERFACE "${IMGUI_INCLUDE_DIR}" "${IMGUI_INCLUDE_DIR}/backends")
    target_link_libraries(imgui::imgui INTERFACE "${IMGUI_LIBRARY}" "${STB_LIBRARY}")
endif()
