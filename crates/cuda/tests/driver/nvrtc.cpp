// What of NVRTC is called: CUDA C++ is compiled by g++, and its "PTX" is the path of the library that comes out.
// <https://docs.nvidia.com/cuda/nvrtc/>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
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
#define __forceinline__ inline
#define __launch_bounds__(threads)
using std::abs, std::floor, std::fma, std::sqrt;
static inline float __uint_as_float(unsigned x) { float y; memcpy(&y, &x, 4); return y; }
static inline unsigned __float_as_uint(float x) { unsigned y; memcpy(&y, &x, 4); return y; }
static inline unsigned __float2uint_rz(float x) { return x >= 4294967296.0f ? ~0u : x > 0.0f ? unsigned(x) : 0u; }
static inline int __float2int_rz(float x) {
    return x >= 2147483648.0f ? 0x7fffffff : x >= -2147483648.0f ? int(x) : x < 0.0f ? int(0x80000000u) : 0;
}
)";

// One thread after the other, with arguments of the types that the kernel takes.
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
        for (threadIdx.x = 0; threadIdx.x < threads; threadIdx.x++)
            call(kernel, arguments, std::index_sequence_for<P...>());
}
extern "C" bool launch_NAME(void** arguments, unsigned blocks, unsigned threads) {
    launch(NAME, arguments, blocks, threads);
    return trapped;
}
)";

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

    std::smatch kernel;
    const std::regex head(R"(__global__\s+void\s+(?:__launch_bounds__\(\d+\)\s+)?(\w+)\()");
    const bool found = std::regex_search(program->source, kernel, head);
    const std::string after = std::regex_replace(AFTER, std::regex("NAME"), found ? kernel[1].str() : "none");
    std::ofstream(source) << BEFORE << "#line 1 \"kernel.cu\"\n" << program->source << after;

    const std::string contract = contracted ? "fast" : "off";
    const std::string command = "g++ -std=c++17 -w -O0 -ffp-contract=" + contract + " -fPIC -shared -Wl,-Bsymbolic -o " +
                                program->library + " " + source + " 2> " + log;
    const bool failed = std::system(command.c_str()) != 0;
    std::ostringstream said;
    said << std::ifstream(log).rdbuf();
    program->log = said.str();
    unlink(source.c_str());
    unlink(log.c_str());
    return failed ? COMPILATION : SUCCESS;
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
