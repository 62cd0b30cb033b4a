gnomon_shared(
    SOURCES box_cells.cpp depth_map.cpp map_lookup.cpp map_resolve.cpp
    SHADERS maps/depth_map.vert maps/map_resolve.vert)
gnomon_algorithm(shadow_map
    SOURCES shadow_map.cpp
    SHADERS maps/shadow_map.frag)
gnomon_algorithm(cascades
    SOURCES cascades.cpp cascade_fit.cpp
    SHADERS maps/cascades.frag)
