gnomon_shared(
    SOURCES blocker_search.cpp box_cells.cpp caster_lists.cpp contact.cpp cube_faces.cpp depth_bounds.cpp
            depth_map.cpp face_light.cpp frusta.cpp kept_map.cpp light_map.cpp map_cells.cpp map_lookup.cpp
            map_resolve.cpp paraboloid_fit.cpp screen_blur.cpp screen_penumbra.cpp seen_part.cpp source_points.cpp
            trapezoid.cpp
    SHADERS shared/contact.frag shared/depth_bounds.comp shared/depth_map.vert shared/fullscreen.vert
            shared/map_resolve.vert shared/screen_blur.frag shared/umbra.frag)
gnomon_shared(
    NEEDS embree
    SOURCES host_visibility.cpp receivers.cpp)
