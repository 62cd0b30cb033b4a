gnomon_algorithm(cube_map
    SOURCES cube_map.cpp
    SHADERS omni/cube_map.frag)
gnomon_algorithm(dual_paraboloid
    SOURCES dual_paraboloid.cpp cut_casters.cpp tessellation.cpp
    SHADERS omni/dual_paraboloid.frag
            omni/paraboloid.vert
            omni/paraboloid.vert:WORLD_SPACE=1:omni/paraboloid_world.vert)
