/* A host that only has the installed package: it must compile as C, link, and get a clear answer. */
#include <gnomon/algorithm.h>
#include <gnomon/gnomon.h>
#include <stdio.h>
#include <string.h>

int main(void)
{
    GnContext context = VK_NULL_HANDLE;
    GnContextCreateInfo info;
    memset(&info, 0, sizeof info);
    if (gnCreateContext(&info, &context) != GN_ERROR_OUT_OF_RANGE) return 1; /* it has no size yet */
    info.structSize = sizeof info;
    const GnResult result = gnCreateContext(&info, &context);
    printf("gnCreateContext without a device: %s\n", gnResultName(result));
    if (gnGetVersion() != GN_VERSION) return 1;
    return result == GN_ERROR_NULL_ARGUMENT && context == VK_NULL_HANDLE ? 0 : 1;
}
