// Sums of all words before each: of 1024 in each workgroup, then of the workgroups' sums, then of both.

struct Scan {
    at: u32,
    length: u32,
    // Where the sums of the workgroups are put.
    sums: u32,
}

@group(0) @binding(0) var<storage, read_write> words: array<u32>;
@group(0) @binding(1) var<uniform> scan: Scan;

var<workgroup> shared_sums: array<u32, 256>;

// The sum of what the threads before this one have; of all in `shared_sums[255]`.
fn before(own: u32, thread: u32) -> u32 {
    shared_sums[thread] = own;
    workgroupBarrier();
    for (var reach = 1u; reach < 256u; reach = reach << 1u) {
        var more = 0u;
        if (thread >= reach) {
            more = shared_sums[thread - reach];
        }
        workgroupBarrier();
        shared_sums[thread] += more;
        workgroupBarrier();
    }
    return shared_sums[thread] - own;
}

@compute @workgroup_size(256)
fn groups(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let first = group.x * 1024u + thread * 4u;
    var own: array<u32, 4>;
    var sum = 0u;
    for (var i = 0u; i < 4u; i++) {
        if (first + i < scan.length) {
            own[i] = words[scan.at + first + i];
        }
        sum += own[i];
    }
    var running = before(sum, thread);
    for (var i = 0u; i < 4u; i++) {
        if (first + i < scan.length) {
            words[scan.at + first + i] = running;
        }
        running += own[i];
    }
    if (thread == 255u) {
        words[scan.sums + group.x] = running;
    }
}

@compute @workgroup_size(256)
fn sums(@builtin(local_invocation_index) thread: u32) {
    let count = (scan.length + 1023u) / 1024u;
    var base = 0u;
    for (var first = 0u; first < count; first += 256u) {
        var own = 0u;
        if (first + thread < count) {
            own = words[scan.sums + first + thread];
        }
        let running = base + before(own, thread);
        if (first + thread < count) {
            words[scan.sums + first + thread] = running;
        }
        base += shared_sums[255];
        workgroupBarrier();
    }
}

@compute @workgroup_size(256)
fn add(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let more = words[scan.sums + group.x];
    let first = group.x * 1024u + thread * 4u;
    for (var i = 0u; i < 4u; i++) {
        if (first + i < scan.length) {
            words[scan.at + first + i] += more;
        }
    }
}
