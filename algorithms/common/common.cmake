gnomon_shared(
    SOURCES caster_lists.cpp face_light.cpp kept_map.cpp map_cells.cpp
    SHADERS shared/fullscreen.vert shared/umbra.frag)
