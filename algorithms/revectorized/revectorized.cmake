gnomon_algorithm(rbsm
    SOURCES rbsm.cpp
    SHADERS revectorized/rbsm.frag
            revectorized/rbsm.frag:MAP_LAYERS=1:revectorized/rbsm_cube.frag)
