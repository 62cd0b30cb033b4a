# Shadow maps with soft edges. One gnomon_algorithm() call a module.
# BRANCHING: optimised, lavapipe takes 1.11 times as long for `moments` and 1.05 for `pcss` (processor time of
# `gnomon bench`, alternated).
gnomon_shared(
    SOURCES moment_maps.cpp
    SHADERS filtered/box_means.comp
            filtered/moments_rows.comp
            filtered/moments_columns.comp:WORDS=1:filtered/moments_columns1.comp
            filtered/moments_columns.comp:WORDS=2:filtered/moments_columns2.comp
            filtered/moments_columns.comp:WORDS=4:filtered/moments_columns4.comp
            filtered/moments_levels.comp:WORDS=1:filtered/moments_levels1.comp
            filtered/moments_levels.comp:WORDS=2:filtered/moments_levels2.comp
            filtered/moments_levels.comp:WORDS=4:filtered/moments_levels4.comp
            filtered/nearest.frag
            filtered/nearest.frag:MAP_LAYERS=1:filtered/nearest_cube.frag)
gnomon_algorithm(pcss
    SOURCES pcss.cpp
    BRANCHING filtered/pcss.frag
              filtered/pcss.frag:MAP_LAYERS=1:filtered/pcss_cube.frag)
gnomon_algorithm(moments
    SOURCES moments.cpp
    BRANCHING filtered/moments.frag
              filtered/moments.frag:MAP_LAYERS=1:filtered/moments_cube.frag)
gnomon_algorithm(moments_soft
    SOURCES moments_soft.cpp summed_tables.cpp
    SHADERS filtered/moments_soft.frag
            filtered/moments_soft.frag:MAP_LAYERS=1:filtered/moments_soft_cube.frag
            filtered/summed_columns.comp
            filtered/summed_rows.comp)
gnomon_algorithm(screen_soft
    SOURCES screen_soft.cpp
    SHADERS filtered/screen_soft.frag
            filtered/screen_soft.frag:MAP_LAYERS=1:filtered/screen_soft_cube.frag)
