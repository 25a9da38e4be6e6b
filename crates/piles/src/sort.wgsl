// Sorts things by a key of few values; those of one key stay in order. In blocks of 256: how many of each key a block
// has, `[key][block]`, which a scan turns into where these begin, and then each thing to its place.

struct Sort {
    // Of each thing its key, below `kinds`.
    keys: u32,
    // Where in the status the number of things stands, and how many there are at most.
    count: u32,
    most: u32,
    kinds: u32,
    blocks: u32,
    matrix: u32,
    // Which thing comes at each place.
    order: u32,
}

@group(0) @binding(0) var<storage, read_write> words: array<u32>;
@group(0) @binding(1) var<storage, read_write> status: array<u32>;
@group(0) @binding(2) var<storage, read> marks: array<u32>;
@group(0) @binding(3) var<uniform> sort: Sort;

const NONE: u32 = 0xffffffffu;
var<workgroup> keys: array<u32, 256>;

fn load(block: u32, thread: u32) -> u32 {
    let i = block * 256u + thread;
    var key = NONE;
    if (i < min(status[sort.count], sort.most)) {
        key = marks[sort.keys + i];
    }
    keys[thread] = key;
    workgroupBarrier();
    return key;
}

@compute @workgroup_size(256)
fn count(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    load(group.x, thread);
    if (thread >= sort.kinds) {
        return;
    }
    var number = 0u;
    for (var i = 0u; i < 256u; i++) {
        number += select(0u, 1u, keys[i] == thread);
    }
    words[sort.matrix + thread * sort.blocks + group.x] = number;
}

@compute @workgroup_size(256)
fn place(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let key = load(group.x, thread);
    if (key == NONE) {
        return;
    }
    var earlier = 0u;
    for (var i = 0u; i < thread; i++) {
        earlier += select(0u, 1u, keys[i] == key);
    }
    let begin = words[sort.matrix + key * sort.blocks + group.x];
    words[sort.order + begin + earlier] = group.x * 256u + thread;
}
