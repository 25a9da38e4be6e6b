// What of NVRTC is called: CUDA C++ is compiled by g++, and its "PTX" is the path of the library that comes out.
// <https://docs.nvidia.com/cuda/nvrtc/>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <mutex>
#include <regex>
#include <sstream>
#include <string>
#include <unistd.h>

using nvrtcResult = int;
constexpr nvrtcResult SUCCESS = 0, INVALID_OPTION = 5, COMPILATION = 6;

struct Program {
    std::string source, library, log;
};

// What every CUDA program knows.
constexpr const char* BEFORE = R"(
#include <cmath>
#include <cstring>
#include <utility>
struct Index { unsigned x, y, z; };
static thread_local Index gridDim, blockIdx, blockDim, threadIdx;
static bool trapped = false;
#define __trap() (trapped = true)
#define __global__
#define __device__
#define __shared__ static thread_local
#define __forceinline__ inline
#define __launch_bounds__(...)
using std::abs, std::floor, std::fma, std::sqrt;
static inline float __uint_as_float(unsigned x) { float y; memcpy(&y, &x, 4); return y; }
static inline unsigned __float_as_uint(float x) { unsigned y; memcpy(&y, &x, 4); return y; }
static inline unsigned __float2uint_rz(float x) { return x >= 4294967296.0f ? ~0u : x > 0.0f ? unsigned(x) : 0u; }
static inline int __float2int_rz(float x) {
    return x >= 2147483648.0f ? 0x7fffffff : x >= -2147483648.0f ? int(x) : x < 0.0f ? int(0x80000000u) : 0;
}
static inline int __clz(int x) { return x == 0 ? 32 : __builtin_clz(x); }
static inline int __popc(unsigned x) { return __builtin_popcount(x); }
static inline unsigned __brev(unsigned x) {
    unsigned y = 0;
    for (int i = 0; i < 32; i++) y |= (x >> i & 1u) << (31 - i);
    return y;
}
// No thread runs while another one does.
static inline void __threadfence_block() {}
#define ATOMIC(NAME, NEXT) \
    static inline unsigned NAME(unsigned* at, unsigned x) { const unsigned old = *at; *at = NEXT; return old; } \
    static inline int NAME(int* at, int x) { const int old = *at; *at = NEXT; return old; }
ATOMIC(atomicAdd, unsigned(old) + unsigned(x))
ATOMIC(atomicSub, unsigned(old) - unsigned(x))
ATOMIC(atomicMin, x < old ? x : old)
ATOMIC(atomicMax, x > old ? x : old)
ATOMIC(atomicAnd, old & x)
ATOMIC(atomicOr, old | x)
ATOMIC(atomicXor, old ^ x)
ATOMIC(atomicExch, x)
#undef ATOMIC
template <typename T> static inline T atomicCAS(T* at, T compared, T x) {
    const T old = *at;
    if (old == compared) *at = x;
    return old;
}
)";

// One thread of a block after the other.
constexpr const char* THREADS = R"(
template <typename F> static void run_block(F thread) {
    for (threadIdx.x = 0; threadIdx.x < blockDim.x; threadIdx.x++) thread();
}
)";

// Threads that wait for each other: each runs up to its next barrier, then the next one does; with a stack of its own.
// A context is only begun as one: to leap asks nothing of the system.
constexpr const char* FIBERS = R"(
#include <csetjmp>
#include <ucontext.h>
constexpr size_t STACK = size_t{1} << 18, MOST_THREADS = 1024;
struct Fiber {
    ucontext_t begin;
    jmp_buf waiting;
    char* stack;
    bool begun, done;
};
static thread_local jmp_buf scheduler;
// As many as a block has at most; with stacks where they were needed.
static thread_local Fiber* fibers = nullptr;
static thread_local void (*fiber_work)(void*);
static thread_local void* fiber_kernel;
static void __syncthreads() {
    if (_setjmp(fibers[threadIdx.x].waiting) == 0) _longjmp(scheduler, 1);
}
static void run_fiber() {
    fiber_work(fiber_kernel);
    fibers[threadIdx.x].done = true;
    _longjmp(scheduler, 1);
}
static void resume(unsigned i) {
    threadIdx.x = i;
    if (_setjmp(scheduler) != 0) return;
    if (fibers[i].begun) _longjmp(fibers[i].waiting, 1);
    fibers[i].begun = true;
    setcontext(&fibers[i].begin);
}
template <typename F> static void run_block(F thread) {
    fiber_work = [](void* kernel) { (*static_cast<F*>(kernel))(); };
    fiber_kernel = &thread;
    if (fibers == nullptr) fibers = new Fiber[MOST_THREADS]();
    for (unsigned i = 0; i < blockDim.x; i++) {
        Fiber& fiber = fibers[i];
        getcontext(&fiber.begin);
        if (fiber.stack == nullptr) fiber.stack = new char[STACK];
        fiber.begin.uc_stack.ss_sp = fiber.stack;
        fiber.begin.uc_stack.ss_size = STACK;
        fiber.begin.uc_link = nullptr;
        fiber.begun = fiber.done = false;
        makecontext(&fiber.begin, run_fiber, 0);
    }
    for (bool waits = true; waits;) {
        waits = false;
        for (unsigned i = 0; i < blockDim.x; i++) {
            if (!fibers[i].done) resume(i);
            waits = waits || !fibers[i].done;
        }
    }
}
)";

// With arguments of the types that a kernel takes.
constexpr const char* AFTER = R"(
template <typename... P, size_t... I>
static void call(void (*kernel)(P...), void** arguments, std::index_sequence<I...>) {
    kernel(*static_cast<P*>(arguments[I])...);
}
template <typename... P>
static void launch(void (*kernel)(P...), void** arguments, unsigned blocks, unsigned threads) {
    gridDim = {blocks, 1, 1};
    blockDim = {threads, 1, 1};
    for (blockIdx.x = 0; blockIdx.x < blocks; blockIdx.x++)
        run_block([=] { ::call(kernel, arguments, std::index_sequence_for<P...>()); });
}
// Where kernels of translated shaders are.
namespace shader {}
using namespace shader;
)";
// For each kernel.
constexpr const char* LAUNCH = R"(
extern "C" bool launch_NAME(void** arguments, unsigned blocks, unsigned threads) {
    ::launch(NAME, arguments, blocks, threads);
    return trapped;
}
)";

// A text for g++.
static std::string complete(const std::string& source) {
    std::ostringstream text;
    const bool waits = source.find("__syncthreads") != std::string::npos;
    text << BEFORE << (waits ? FIBERS : THREADS) << "#line 1 \"kernel.cu\"\n" << source << AFTER;
    const std::regex head(R"(__global__\s+void\s+(?:__launch_bounds__\([\d, ]+\)\s+)?(\w+)\()");
    const std::sregex_iterator end;
    for (std::sregex_iterator kernel(source.begin(), source.end(), head); kernel != end; ++kernel)
        text << std::regex_replace(LAUNCH, std::regex("NAME"), (*kernel)[1].str());
    return text.str();
}

// The library of what has been compiled before, by command and text: most tests of piles take the same kernels. Kept as
// bytes, as each module has static variables of its own, and no file remains when a program ends.
static std::mutex before_lock;
static std::map<std::string, std::string> before;

static std::string bytes_of(const std::string& path) {
    std::ostringstream bytes;
    bytes << std::ifstream(path, std::ios::binary).rdbuf();
    return bytes.str();
}

extern "C" {

nvrtcResult nvrtcCreateProgram(Program** program, const char* source, const char*, int, const char**, const char**) {
    *program = new Program{source, "", ""};
    return SUCCESS;
}
nvrtcResult nvrtcDestroyProgram(Program** program) {
    delete *program;
    *program = nullptr;
    return SUCCESS;
}

nvrtcResult nvrtcCompileProgram(Program* program, int count, const char** options) {
    bool contracted = true;
    for (int i = 0; i < count; i++) {
        const std::string option = options[i];
        const bool exact = option == "--ftz=false" || option == "--prec-div=true" || option == "--prec-sqrt=true";
        const bool architecture = option.rfind("--gpu-architecture=compute_", 0) == 0;
        if (option == "--fmad=false") contracted = false;
        else if (!exact && !architecture) return INVALID_OPTION;
    }
    static std::atomic<int> compiled{0};
    const char* folder = getenv("TMPDIR");
    std::ostringstream path;
    path << (folder ? folder : "/tmp") << "/kernel-" << getpid() << "-" << compiled++;
    const std::string source = path.str() + ".cpp", log = path.str() + ".log";
    program->library = path.str() + ".so";

    const std::string contract = contracted ? "fast" : "off", key = contract + program->source;
    {
        const std::lock_guard<std::mutex> lock(before_lock);
        const auto found = before.find(key);
        if (found != before.end()) {
            std::ofstream(program->library, std::ios::binary) << found->second;
            return SUCCESS;
        }
    }

    std::ofstream(source) << complete(program->source);
    const std::string command = "g++ -std=c++17 -w -O0 -ffp-contract=" + contract + " -fPIC -shared -Wl,-Bsymbolic -o " +
                                program->library + " " + source + " 2> " + log;
    const bool failed = std::system(command.c_str()) != 0;
    program->log = bytes_of(log);
    unlink(source.c_str());
    unlink(log.c_str());
    if (failed) return COMPILATION;
    const std::lock_guard<std::mutex> lock(before_lock);
    before[key] = bytes_of(program->library);
    return SUCCESS;
}

nvrtcResult nvrtcGetProgramLogSize(Program* program, size_t* size) {
    *size = program->log.size() + 1;
    return SUCCESS;
}
nvrtcResult nvrtcGetProgramLog(Program* program, char* log) {
    strcpy(log, program->log.c_str());
    return SUCCESS;
}
nvrtcResult nvrtcGetPTXSize(Program* program, size_t* size) {
    *size = program->library.size() + 1;
    return SUCCESS;
}
nvrtcResult nvrtcGetPTX(Program* program, char* ptx) {
    strcpy(ptx, program->library.c_str());
    return SUCCESS;
}

}
