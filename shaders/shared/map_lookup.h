// How a resolve pass looks at a map: constants of the view, the light and the map's projection.
#ifndef GNOMON_MAPS_MAP_LOOKUP_H
#define GNOMON_MAPS_MAP_LOOKUP_H
#include "map_look.h"
#include "receiver.h"

GN_SHARED_BEGIN

struct MapConstants {
    ViewConstants view;
    MapLookup map;
};
GN_SHARED_SIZE(MapConstants, 416)

GN_SHARED_END
#endif
