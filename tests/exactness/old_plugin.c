/* A shared object that says it is a plug-in of another day; with GN_NO_VERSION, of none. */
#include <gnomon/algorithm.h>

#ifndef GN_NO_VERSION
extern GN_EXPORT const uint32_t gnPluginVersion;
const uint32_t gnPluginVersion = GN_PLUGIN_VERSION + 1;
#endif

GN_EXPORT GnResult GN_CALL gnPluginMain(GnContext context, const GnPluginInterface* pInterface);

GnResult GN_CALL gnPluginMain(GnContext context, const GnPluginInterface* pInterface)
{
    (void)context, (void)pInterface;
    return GN_SUCCESS;
}
