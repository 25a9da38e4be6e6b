// What of CUDA's driver is called, on the processor: <https://docs.nvidia.com/cuda/cuda-driver-api/>.
// One stream, whose work is done when a call returns; one card that works, one that is too old, and one that is not to
// be had.

#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <dlfcn.h>
#include <unistd.h>

using CUresult = int;
constexpr CUresult SUCCESS = 0, INVALID_VALUE = 1, OUT_OF_MEMORY = 2, UNAVAILABLE = 46, INVALID_DEVICE = 101,
                   INVALID_IMAGE = 200, UNSUPPORTED_PTX = 222, NOT_FOUND = 500, LAUNCH_FAILED = 719;

constexpr int CARDS = 3, OLD = 1, TAKEN = 2;

// More than this at once is taken for more than there is.
constexpr size_t MOST_BYTES = size_t{1} << 30;

using Moment = std::chrono::steady_clock::time_point;

static bool failed = false;
static char context;
static thread_local void* current = nullptr;

static CUresult alive() { return failed ? LAUNCH_FAILED : SUCCESS; }

// What an image is compiled to, which tells whether it has trapped: see nvrtc.cpp.
using Kernel = bool (*)(void** arguments, unsigned blocks, unsigned threads);

extern "C" {

CUresult cuInit(unsigned) { return SUCCESS; }
CUresult cuDriverGetVersion(int* version) { *version = 13000; return SUCCESS; }
CUresult cuGetErrorString(CUresult error, const char** text) {
    switch (error) {
    case OUT_OF_MEMORY: *text = "out of memory"; return SUCCESS;
    case LAUNCH_FAILED: *text = "unspecified launch failure"; return SUCCESS;
    default: *text = nullptr; return INVALID_VALUE;
    }
}

CUresult cuDeviceGetCount(int* count) { *count = CARDS; return SUCCESS; }
CUresult cuDeviceGet(int* device, int ordinal) {
    *device = ordinal;
    return ordinal < CARDS ? SUCCESS : INVALID_DEVICE;
}
CUresult cuDeviceGetName(char* name, int length, int device) {
    strncpy(name, device == OLD ? "old processor" : device == TAKEN ? "taken processor" : "processor", length);
    return SUCCESS;
}
CUresult cuDeviceTotalMem_v2(size_t* bytes, int) { *bytes = size_t{16} << 30; return SUCCESS; }
CUresult cuDeviceGetAttribute(int* value, int attribute, int device) {
    constexpr int CAPABILITY_MAJOR = 75, CAPABILITY_MINOR = 76, MEMORY_POOLS_SUPPORTED = 115;
    switch (attribute) {
    case CAPABILITY_MAJOR: *value = 7; break;
    case CAPABILITY_MINOR: *value = device == OLD ? 0 : 5; break;
    default: *value = attribute == MEMORY_POOLS_SUPPORTED;
    }
    return SUCCESS;
}

CUresult cuDevicePrimaryCtxRetain(void** into, int device) {
    *into = &context;
    return device == TAKEN ? UNAVAILABLE : alive();
}
CUresult cuDevicePrimaryCtxRelease_v2(int) { return SUCCESS; }
CUresult cuCtxGetCurrent(void** into) { *into = current; return SUCCESS; }
CUresult cuCtxSetCurrent(void* to) { current = to; return alive(); }

CUresult cuEventCreate(void** event, unsigned) { *event = new Moment; return alive(); }
CUresult cuEventDestroy_v2(void* event) { delete static_cast<Moment*>(event); return alive(); }
CUresult cuEventRecord(void* event, void*) {
    *static_cast<Moment*>(event) = std::chrono::steady_clock::now();
    return alive();
}
CUresult cuEventSynchronize(void*) { return alive(); }
CUresult cuEventElapsedTime_v2(float* milliseconds, void* start, void* end) {
    const auto taken = *static_cast<Moment*>(end) - *static_cast<Moment*>(start);
    *milliseconds = std::chrono::duration<float, std::milli>(taken).count();
    return alive();
}
CUresult cuStreamWaitEvent(void*, void*, unsigned) { return alive(); }
CUresult cuStreamSynchronize(void*) { return alive(); }

CUresult cuMemAllocAsync(uint64_t* pointer, size_t bytes, void*) {
    if (bytes == 0) return INVALID_VALUE;
    // What a program has not written has no particular value.
    void* memory = bytes > MOST_BYTES ? nullptr : malloc(bytes);
    if (memory == nullptr) return OUT_OF_MEMORY;
    memset(memory, 0xa5, bytes < 4096 ? bytes : 4096);
    *pointer = reinterpret_cast<uint64_t>(memory);
    return alive();
}
CUresult cuMemFreeAsync(uint64_t pointer, void*) {
    free(reinterpret_cast<void*>(pointer));
    return alive();
}
CUresult cuMemsetD8Async(uint64_t to, unsigned char value, size_t bytes, void*) {
    if (alive() == SUCCESS) memset(reinterpret_cast<void*>(to), value, bytes);
    return alive();
}
CUresult cuMemcpyHtoDAsync_v2(uint64_t to, const void* from, size_t bytes, void*) {
    if (alive() == SUCCESS) memcpy(reinterpret_cast<void*>(to), from, bytes);
    return alive();
}
CUresult cuMemcpyDtoHAsync_v2(void* to, uint64_t from, size_t bytes, void*) {
    if (alive() == SUCCESS) memcpy(to, reinterpret_cast<void*>(from), bytes);
    return alive();
}
CUresult cuMemcpyDtoDAsync_v2(uint64_t to, uint64_t from, size_t bytes, void*) {
    if (alive() == SUCCESS) memcpy(reinterpret_cast<void*>(to), reinterpret_cast<const void*>(from), bytes);
    return alive();
}

// An image is the path of what was compiled. With a kernel `refused`, it is taken for that of a compiler newer than this.
CUresult cuModuleLoadData(void** module, const void* image) {
    const char* path = static_cast<const char*>(image);
    *module = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    unlink(path);
    if (*module == nullptr) return INVALID_IMAGE;
    return dlsym(*module, "launch_entry_refused") ? UNSUPPORTED_PTX : alive();
}
CUresult cuModuleUnload(void*) { return alive(); }
CUresult cuModuleGetFunction(void** function, void* module, const char* name) {
    char symbol[256] = "launch_";
    strncat(symbol, name, sizeof symbol - strlen(symbol) - 1);
    *function = dlsym(module, symbol);
    return *function == nullptr ? NOT_FOUND : SUCCESS;
}
CUresult cuLaunchKernel(void* function, unsigned blocks, unsigned, unsigned, unsigned threads, unsigned, unsigned,
                        unsigned, void*, void** arguments, void**) {
    if (alive() == SUCCESS) failed = reinterpret_cast<Kernel>(function)(arguments, blocks, threads);
    return alive();
}

}
