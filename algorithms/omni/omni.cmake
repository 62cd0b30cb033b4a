gnomon_shared(
    SOURCES cut_casters.cpp paraboloid_maps.cpp tessellation.cpp
    SHADERS omni/paraboloid.frag
            omni/paraboloid.vert
            omni/paraboloid.vert:WORLD_SPACE=1:omni/paraboloid_world.vert)
gnomon_algorithm(cube_map
    SOURCES cube_map.cpp
    SHADERS omni/cube_map.frag)
gnomon_algorithm(dual_paraboloid SOURCES dual_paraboloid.cpp)
gnomon_algorithm(improved_paraboloid SOURCES improved_paraboloid.cpp)
gnomon_algorithm(skewed_paraboloid SOURCES skewed_paraboloid.cpp)
