# Shadow maps that spend their texels where the view looks. One gnomon_algorithm() call a module.
gnomon_shared(
    SOURCES warped_map.cpp
    SHADERS warped/warped_map.frag)
gnomon_algorithm(trapezoidal
    SOURCES trapezoidal.cpp)
gnomon_algorithm(perspective_warp
    SOURCES perspective_warp.cpp)
gnomon_shared(SOURCES table_map.cpp)
gnomon_algorithm(rectilinear_warp
    SOURCES rectilinear_warp.cpp
    SHADERS warped/rectilinear_edges.comp warped/rectilinear_places.comp
            warped/importance.comp:RECTILINEAR=1:warped/importance_rectilinear.comp
            warped/casters.vert:RECTILINEAR=1:warped/casters_rectilinear.vert
            warped/casters.frag:RECTILINEAR=1:warped/casters_rectilinear.frag
            warped/resolve.frag:RECTILINEAR=1:warped/resolve_rectilinear.frag)
gnomon_algorithm(nonorthogonal_warp
    SOURCES nonorthogonal_warp.cpp
    SHADERS warped/importance.comp warped/functions.comp warped/functions.comp:COLUMNS=1:warped/functions_columns.comp
            warped/smooth.comp warped/smooth.comp:COLUMNS=1:warped/smooth_columns.comp
            warped/recount.comp warped/bounds.comp warped/places.comp
            warped/casters.vert warped/casters.frag warped/resolve.frag)
