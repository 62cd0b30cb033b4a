# Shadow maps that spend their texels where the view looks. One gnomon_algorithm() call a module.
gnomon_shared(
    SOURCES warped_map.cpp
    SHADERS warped/warped_map.frag)
gnomon_algorithm(trapezoidal
    SOURCES trapezoidal.cpp)
gnomon_algorithm(perspective_warp
    SOURCES perspective_warp.cpp)
