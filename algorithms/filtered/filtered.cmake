# Shadow maps with soft edges. One gnomon_algorithm() call a module.
gnomon_shared(
    SOURCES depth_bounds.cpp
    SHADERS filtered/depth_bounds.comp)
gnomon_algorithm(pcss
    SOURCES pcss.cpp
    SHADERS filtered/pcss.frag
            filtered/pcss.frag:MAP_LAYERS=1:filtered/pcss_cube.frag
            filtered/pcss.frag:HARD=1:filtered/pcss_hard.frag
            filtered/pcss.frag:HARD=2:filtered/pcss_hard_cube.frag)
