gnomon_algorithm(shadow_map
    SOURCES shadow_map.cpp desired_view.cpp
    SHADERS maps/shadow_map.frag maps/shadow_map.frag:CROPPED=1:maps/shadow_map_cropped.frag
            maps/desired_view.comp maps/desired_view.vert maps/desired_view_crop.comp)
gnomon_algorithm(cascades
    SOURCES cascades.cpp cascade_fit.cpp
    SHADERS maps/cascades.frag)
gnomon_algorithm(virtual_map
    SOURCES virtual_map.cpp page_grid.cpp page_requests.cpp page_slots.cpp view_solid.cpp
    SHADERS maps/virtual_map.frag)
