gnomon_shared(
    SOURCES line_map.cpp
    SHADERS revectorized/lines.frag
            revectorized/lines.frag:MAP_LAYERS=1:revectorized/lines_cube.frag)
gnomon_algorithm(rbsm SOURCES rbsm.cpp)
gnomon_algorithm(rpcf SOURCES rpcf.cpp)
gnomon_algorithm(rbssm
    SOURCES rbssm.cpp
    SHADERS revectorized/rbssm.frag
            revectorized/rbssm.frag:MAP_LAYERS=1:revectorized/rbssm_cube.frag)
gnomon_algorithm(ssrbssm
    SOURCES ssrbssm.cpp
    SHADERS revectorized/ssrbssm.frag
            revectorized/ssrbssm.frag:MAP_LAYERS=1:revectorized/ssrbssm_cube.frag)
