#include "gnomon/gnomon.h"

uint32_t GN_CALL gnGetVersion(void)
{
    return GN_VERSION;
}

const char* GN_CALL gnResultName(GnResult result)
{
    switch (result) {
#define GN_NAME(name)                                                                                                  \
    case name:                                                                                                         \
        return #name;
        GN_NAME(GN_SUCCESS)
        GN_NAME(GN_NOT_READY)
        GN_NAME(GN_TIMEOUT)
        GN_NAME(GN_INCOMPLETE)
        GN_NAME(GN_ERROR_UNKNOWN)
        GN_NAME(GN_ERROR_OUT_OF_HOST_MEMORY)
        GN_NAME(GN_ERROR_OUT_OF_DEVICE_MEMORY)
        GN_NAME(GN_ERROR_DEVICE_LOST)
        GN_NAME(GN_ERROR_INVALID_HANDLE)
        GN_NAME(GN_ERROR_NULL_ARGUMENT)
        GN_NAME(GN_ERROR_NOT_A_NUMBER)
        GN_NAME(GN_ERROR_INFINITE)
        GN_NAME(GN_ERROR_OUT_OF_RANGE)
        GN_NAME(GN_ERROR_EMPTY)
        GN_NAME(GN_ERROR_TOO_MANY)
        GN_NAME(GN_ERROR_FEATURE_MISSING)
        GN_NAME(GN_ERROR_RULES)
        GN_NAME(GN_ERROR_UNKNOWN_METHOD)
        GN_NAME(GN_ERROR_FRAME_ORDER)
        GN_NAME(GN_ERROR_UNSUPPORTED)
        GN_NAME(GN_ERROR_KNOWLEDGE)
        GN_NAME(GN_RESULT_MAX_ENUM)
#undef GN_NAME
    }
    return "not a GnResult";
}
