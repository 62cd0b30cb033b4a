"""A host in Python: gnomon's C API by ctypes. Arguments: libgnomon.so, and libconsumer_device.so (device.c), which has
the Vulkan device. Structures may end after the last member that is needed: structSize says how much of one is there."""
import sys
from ctypes import *

POINTERS = "instance gpu device queue features load depth depthView memory pool".split()
ConsumerDevice = type("ConsumerDevice", (Structure,), {"_fields_": [(name, c_void_p) for name in POINTERS]})


def structure(name, *members):
    return type(name, (Structure,), {"_fields_": [("structSize", c_uint32), *members]})


ContextInfo = structure("ContextInfo", ("flags", c_uint32), ("name", c_char_p), ("instance", c_void_p),
                        ("gpu", c_void_p), ("device", c_void_p), ("queue", c_void_p), ("family", c_uint32),
                        ("apiVersion", c_uint32), ("features", c_void_p), ("extensions", c_uint32),
                        ("extensionNames", c_void_p), ("load", c_void_p))
MeshInfo = structure("MeshInfo", ("name", c_char_p), ("positions", POINTER(c_float)), ("count", c_uint32),
                     ("stride", c_uint32))
InstanceInfo = structure("InstanceInfo", ("flags", c_uint32), ("name", c_char_p), ("mesh", c_uint64))
LightInfo = structure("LightInfo", ("type", c_int), ("flags", c_uint32), ("name", c_char_p), ("position", c_double * 3),
                      ("direction", c_float * 3), ("range", c_float))
ViewFrame = structure("ViewFrame", ("view", c_uint64), ("eye", c_double * 3), ("viewFromWorld", c_float * 9),
                      ("projection", c_float * 16), ("convention", c_int), ("depth", c_void_p), ("depthView", c_void_p),
                      ("format", c_int), ("extent", c_uint32 * 2), ("area", c_int32 * 4), ("cut", c_uint32),
                      ("normals", c_void_p), ("normalView", c_void_p), ("normalFormat", c_int),
                      ("lightCount", c_uint32), ("lights", POINTER(c_uint64)))
FrameInfo = structure("FrameInfo", ("frame", c_uint64), ("completed", c_uint64), ("flags", c_uint32),
                      ("budgetMs", c_float), ("viewCount", c_uint32), ("views", POINTER(ViewFrame)))
Decision = structure("Decision", ("method", c_char_p), ("reason", c_int))

gnomon, host, device = CDLL(sys.argv[1]), CDLL(sys.argv[2]), ConsumerDevice()
gnomon.gnGetLastError.restype = c_char_p
context = c_void_p()


def call(function, *arguments):
    if function(*arguments) < 0:
        sys.exit(f"{function.__name__}: {gnomon.gnGetLastError(context).decode()}")


def create(function, info):
    handle = c_uint64()
    call(function, context, byref(info) if info else None, byref(handle))
    return handle.value


if opened := host.consumerOpen(byref(device)):
    sys.exit(opened)
info = ContextInfo(sizeof(ContextInfo), apiVersion=(1 << 22) | (3 << 12), instance=device.instance, gpu=device.gpu,
                   device=device.device, queue=device.queue, features=device.features, load=device.load)
call(gnomon.gnCreateContext, byref(info), byref(context))
call(gnomon.gnLoadShippedRules, context, b"default")
corners = [-9, 0, -9, -9, 0, 9, 9, 0, 9, -9, 0, -9, 9, 0, 9, 9, 0, -9, -1, 1, 0, 1, 1, 0, 0, 1, -.5]
mesh = create(gnomon.gnCreateMesh, MeshInfo(sizeof(MeshInfo), None, (c_float * len(corners))(*corners), 9))
create(gnomon.gnCreateInstance, InstanceInfo(sizeof(InstanceInfo), 1, None, mesh))
sun = create(gnomon.gnCreateLight, LightInfo(sizeof(LightInfo), direction=(0, -1, 0)))
view = create(gnomon.gnCreateView, None)
call(gnomon.gnWarmUp, context)
camera = ViewFrame(sizeof(ViewFrame), view, (0, 4, 0), (1, 0, 0, 0, 0, -1, 0, 1, 0),
                   (2.5, 0, 0, 0, 0, -2.5, 0, 0, 0, 0, 0, -1, 0, 0, .1, 0), 0, device.depth, device.depthView, 126,
                   (64, 64), lightCount=1, lights=pointer(c_uint64(sun)))
frame = FrameInfo(sizeof(FrameInfo), frame=1, viewCount=1, views=pointer(camera))
call(gnomon.gnSubmitShadows, context, byref(frame))
decision = Decision(sizeof(Decision))
call(gnomon.gnGetDecision, context, c_uint64(view), c_uint64(sun), byref(decision))
print(f"decision: {decision.method.decode()}, reason {decision.reason}")
gnomon.gnDestroyContext(context)
host.consumerClose(byref(device))
