// A host in Rust: gnomon's C API, declared by hand. Linked with libgnomon.so, and with libconsumer_device.so (device.c)
// for the Vulkan device. Structures may end after the last member that is needed, since structSize says so; but not in
// padding, which Rust leaves undefined.
use std::ffi::CStr;
use std::mem::{size_of, zeroed};
use std::os::raw::{c_char, c_void};
use std::ptr::{null, null_mut};

type Pointer = *mut c_void;

#[repr(C)]
struct ConsumerDevice {
    instance: Pointer,
    gpu: Pointer,
    device: Pointer,
    queue: Pointer,
    features: Pointer,
    load: Pointer,
    depth: Pointer,
    depth_view: Pointer,
    memory: Pointer,
    pool: Pointer,
}

#[repr(C)]
struct ContextInfo {
    struct_size: u32,
    flags: u32,
    name: *const c_char,
    instance: Pointer,
    gpu: Pointer,
    device: Pointer,
    queue: Pointer,
    family: u32,
    api_version: u32,
    features: Pointer,
    extension_count: u32,
    extension_names: Pointer,
    load: Pointer,
}

#[repr(C)]
struct MeshInfo {
    struct_size: u32,
    name: *const c_char,
    positions: *const f32,
    count: u32,
    stride: u32,
}

#[repr(C)]
struct InstanceInfo {
    struct_size: u32,
    flags: u32,
    name: *const c_char,
    mesh: u64,
}

#[repr(C)]
struct LightInfo {
    struct_size: u32,
    kind: i32,
    flags: u32,
    name: *const c_char,
    position: [f64; 3],
    direction: [f32; 3],
    range: f32,
}

#[repr(C)]
struct ViewFrame {
    struct_size: u32,
    view: u64,
    eye: [f64; 3],
    view_from_world: [f32; 9],
    projection: [f32; 16],
    convention: i32,
    depth: Pointer,
    depth_view: Pointer,
    format: i32,
    extent: [u32; 2],
    area: [i32; 4],
    camera_cut: u32,
    normals: Pointer,
    normal_view: Pointer,
    normal_format: i32,
    light_count: u32,
    lights: *const u64,
}

#[repr(C)]
struct FrameInfo {
    struct_size: u32,
    frame: u64,
    completed: u64,
    flags: u32,
    budget_ms: f32,
    view_count: u32,
    views: *const ViewFrame,
}

#[repr(C)]
struct Decision {
    struct_size: u32,
    method: *const c_char,
    reason: i32,
}

extern "C" {
    fn consumerOpen(device: *mut ConsumerDevice) -> i32;
    fn consumerClose(device: *mut ConsumerDevice);
    fn gnCreateContext(info: *const ContextInfo, context: *mut Pointer) -> i32;
    fn gnDestroyContext(context: Pointer);
    fn gnGetLastError(context: Pointer) -> *const c_char;
    fn gnLoadShippedRules(context: Pointer, name: *const c_char) -> i32;
    fn gnCreateMesh(context: Pointer, info: *const MeshInfo, mesh: *mut u64) -> i32;
    fn gnCreateInstance(context: Pointer, info: *const InstanceInfo, instance: *mut u64) -> i32;
    fn gnCreateLight(context: Pointer, info: *const LightInfo, light: *mut u64) -> i32;
    fn gnCreateView(context: Pointer, info: *const c_void, view: *mut u64) -> i32;
    fn gnWarmUp(context: Pointer) -> i32;
    fn gnSubmitShadows(context: Pointer, frame: *const FrameInfo) -> i32;
    fn gnGetDecision(context: Pointer, view: u64, light: u64, decision: *mut Decision) -> i32;
}

fn size<T>() -> u32 {
    size_of::<T>() as u32
}

/// The value of a call that fills `out`, or the library's sentence.
unsafe fn made<T: Copy>(context: Pointer, mut out: T, call: impl FnOnce(*mut T) -> i32) -> Result<T, String> {
    if call(&mut out) < 0 {
        return Err(CStr::from_ptr(gnGetLastError(context)).to_string_lossy().into_owned());
    }
    Ok(out)
}

unsafe fn decide(device: &ConsumerDevice, context: Pointer) -> Result<String, String> {
    made(context, (), |_| gnLoadShippedRules(context, b"default\0".as_ptr().cast()))?;
    let corners: [f32; 27] = [
        -9., 0., -9., -9., 0., 9., 9., 0., 9., -9., 0., -9., 9., 0., 9., 9., 0., -9., // floor
        -1., 1., 0., 1., 1., 0., 0., 1., -0.5, // sail
    ];
    let mesh_size = size::<MeshInfo>();
    let info = MeshInfo { struct_size: mesh_size, name: null(), positions: corners.as_ptr(), count: 9, stride: 12 };
    let mesh = made(context, 0, |out| gnCreateMesh(context, &info, out))?;
    let placed = InstanceInfo { struct_size: size::<InstanceInfo>(), flags: 1, name: null(), mesh };
    made(context, 0, |out| gnCreateInstance(context, &placed, out))?;
    let down = LightInfo { struct_size: size::<LightInfo>(), direction: [0., -1., 0.], ..zeroed() };
    let sun = made(context, 0, |out| gnCreateLight(context, &down, out))?;
    let view = made(context, 0, |out| gnCreateView(context, null(), out))?;
    made(context, (), |_| gnWarmUp(context))?;
    let camera = ViewFrame {
        struct_size: size::<ViewFrame>(),
        view,
        eye: [0., 4., 0.],
        view_from_world: [1., 0., 0., 0., 0., -1., 0., 1., 0.],
        projection: [2.5, 0., 0., 0., 0., -2.5, 0., 0., 0., 0., 0., -1., 0., 0., 0.1, 0.],
        depth: device.depth,
        depth_view: device.depth_view,
        format: 126, // D32_SFLOAT
        extent: [64, 64],
        light_count: 1,
        lights: &sun,
        ..zeroed()
    };
    let frame = FrameInfo { struct_size: size::<FrameInfo>(), frame: 1, view_count: 1, views: &camera, ..zeroed() };
    made(context, (), |_| gnSubmitShadows(context, &frame))?;
    let mut decision = Decision { struct_size: size::<Decision>(), ..zeroed() };
    made(context, (), |_| gnGetDecision(context, view, sun, &mut decision))?;
    Ok(format!("{}, reason {}", CStr::from_ptr(decision.method).to_string_lossy(), decision.reason))
}

fn main() {
    unsafe {
        let mut device: ConsumerDevice = zeroed();
        let opened = consumerOpen(&mut device);
        if opened != 0 {
            std::process::exit(opened);
        }
        let info = ContextInfo {
            struct_size: size::<ContextInfo>(),
            instance: device.instance,
            gpu: device.gpu,
            device: device.device,
            queue: device.queue,
            api_version: 1 << 22 | 3 << 12,
            features: device.features,
            load: device.load,
            ..zeroed()
        };
        let mut context = null_mut();
        let status = gnCreateContext(&info, &mut context);
        let answer = if status < 0 { Err(format!("gnCreateContext: {status}")) } else { decide(&device, context) };
        gnDestroyContext(context);
        consumerClose(&mut device);
        match answer {
            Ok(text) => println!("decision: {text}"),
            Err(text) => {
                eprintln!("{text}");
                std::process::exit(1)
            }
        }
    }
}
