gnomon_shared(
    SOURCES facing.cpp shadow_reach.cpp silhouette.cpp stencil_resolve.cpp view_stencil.cpp
    SHADERS volumes/receiver_strips.comp
            volumes/receiver_tiles.comp
            volumes/resolve.frag
            volumes/resolve.vert
            volumes/resolve_tiles.vert)
gnomon_shared(
    NEEDS openmesh
    SOURCES edge_list.cpp edge_volumes.cpp mesh_planes.cpp mesh_volumes.cpp shadow_region.cpp
            static_volumes.cpp volume_count.cpp volume_cull.cpp volume_draw.cpp volume_list.cpp volume_tree.cpp
    SHADERS volumes/all_edges.vert
            volumes/cull_volumes.comp
            volumes/mesh_caps.comp
            volumes/mesh_planes.comp
            volumes/mesh_sides.comp
            volumes/reached_tiles.comp
            volumes/volume.vert)
gnomon_algorithm(stencil_volume
    NEEDS openmesh
    SOURCES stencil_volume.cpp)
gnomon_algorithm(chan_durand
    NEEDS openmesh
    SOURCES chan_durand.cpp light_cells.cpp
    SHADERS volumes/chan_durand.frag
            volumes/chan_durand.frag:MAP_LAYERS=1:volumes/chan_durand_cube.frag
            volumes/chan_durand_cull.comp)
gnomon_algorithm(octree_volume
    NEEDS openmesh
    SOURCES octree_volume.cpp)
gnomon_algorithm(all_edges_volume
    NEEDS openmesh
    SOURCES all_edges_volume.cpp)
gnomon_algorithm(projected_planar
    NEEDS openmesh
    SOURCES projected_planar.cpp
    SHADERS volumes/planar.vert volumes/planar_choose.comp volumes/planar_resolve.frag volumes/planar_tiles.comp)
gnomon_algorithm(penumbra_wedges
    NEEDS openmesh
    SOURCES penumbra_wedges.cpp
    SHADERS volumes/wedge.frag volumes/wedge.vert volumes/wedge_resolve.frag)
gnomon_algorithm(multi_volume
    NEEDS openmesh
    SOURCES multi_volume.cpp
    SHADERS volumes/multi_volume_sum.frag volumes/multi_volume_resolve.frag)
gnomon_algorithm(mccool
    SOURCES mccool.cpp depth_surface.cpp
    SHADERS volumes/mccool.vert
            volumes/mccool_cap.frag
            volumes/mccool_cap.vert
            volumes/mccool_edges.comp
            volumes/mccool_polygons.comp)
# Looks receivers up on the CPU, as hybrids do.
gnomon_algorithm(angular_spans
    NEEDS embree openmesh
    SOURCES angular_spans.cpp light_spans.cpp span_table.cpp)
