// What a step gave that is cut into parts: contacts of the parts before, which the state remembers, give what they gave to
// those of the same two shapes and the nearest normal; where there is none any more, they are told of once more, behind
// those of the same shapes, and give nothing.

// The contact at a place in the order of all that are told of.
fn contact_at(place: u32) -> u32 {
    if (told(ENDED) == 0u) {
        return place;
    }
    return word(plan.merged + place);
}

fn key_of(contact: u32) -> vec2<u32> {
    let a = u32(fresh[contact * REMEMBERED + REMEMBERED_SHAPES]);
    let b = u32(fresh[contact * REMEMBERED + REMEMBERED_SHAPES + 1u]);
    return vec2(min(a, b), max(a, b));
}
// How many contacts come before a key; with `also`, those of it, too.
fn found_before(key: vec2<u32>, also: bool) -> u32 {
    var begin = 0u;
    var end = contact_count();
    while (begin < end) {
        let middle = (begin + end) / 2u;
        let own = key_of(middle);
        if (comes_before(own, key) || (also && all(own == key))) {
            begin = middle + 1u;
        } else {
            end = middle;
        }
    }
    return begin;
}

// Whether a remembered contact has given anything in the step.
fn gave(i: u32) -> bool {
    let at = memory_at(i);
    var any_ = false;
    for (var x = 0u; x < 3u; x++) {
        any_ = any_ || state[at + REMEMBERED_DRAG_SUM + x] != 0.0;
    }
    for (var p = 0u; p < min(u32(state[at + REMEMBERED_POINTS]), POINTS); p++) {
        any_ = any_ || state[at + REMEMBERED_POINT + p * REMEMBERED_POINT_WIDTH + 6u] > 0.0;
    }
    return any_;
}

// The contact that what a remembered one gave goes to, or NONE.
fn heir_of(i: u32) -> u32 {
    let key = old_key(i);
    var heir = NONE;
    var most = SAME_NORMAL;
    for (var c = found_before(key, false); c < contact_count() && all(key_of(c) == key); c++) {
        let cosine = dot(fresh_normal(c), remembered_normal(i));
        // The last of those that are as near.
        if (cosine > SAME_NORMAL && cosine >= most) {
            most = cosine;
            heir = c;
        }
    }
    return heir;
}

@compute @workgroup_size(64)
fn find_ended(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = id.x;
    let all_places = plan.worlds * plan.remembered;
    if (i > all_places) {
        return;
    }
    var ended = 0u;
    if (i < all_places && is_remembered(i) && runs_in(world_of_old(i))) {
        ended = select(0u, 1u, gave(i) && heir_of(i) == NONE);
    }
    put(plan.ended + i, ended);
}

// Of each contact, which remembered one gives to it in this round: those of its shapes in turn.
@compute @workgroup_size(64)
fn match_parts(@builtin(global_invocation_id) id: vec3<u32>) {
    let contact = id.x;
    if (contact >= contact_count()) {
        return;
    }
    let key = key_of(contact);
    var skip = told(SUM_ROUND);
    var same = NONE;
    for (var i = olds_before(key); is_of(i, key); i++) {
        if (!gave(i) || heir_of(i) != contact) {
            continue;
        }
        if (skip == 0u) {
            same = i;
            break;
        }
        skip--;
    }
    put(plan.same + contact, same);
    // More than the host has rounds for.
    if (told(SUM_ROUND) == SUM_ROUNDS && same != NONE) {
        stop_in(world_of(key.x), PROCESSOR);
    }
}

// A number of a remembered contact, with its shapes as they are counted here.
fn remembered_number(i: u32, field: u32) -> f32 {
    let number = state[memory_at(i) + field];
    if (field == REMEMBERED_SHAPES || field == REMEMBERED_SHAPES + 1u) {
        return min(number, f32(plan.own_shapes - 1u)) + f32(world_of_old(i) * plan.own_shapes);
    }
    return number;
}

// Both of them, to lanes that contacts have left.
@compute @workgroup_size(64)
fn seat_parts(@builtin(global_invocation_id) id: vec3<u32>) {
    let contact = id.x;
    if (contact == 0u) {
        run(SUMS_RUN, 0u, contact_count());
    }
    if (contact >= contact_count()) {
        return;
    }
    let same = word(plan.same + contact);
    for (var i = 0u; i < REMEMBERED; i++) {
        var before = 0.0;
        if (same != NONE) {
            before = remembered_number(same, i);
        }
        put_contact(i, contact, fresh[contact * REMEMBERED + i]);
        put_contact(REMEMBERED + i, contact, before);
    }
}

@compute @workgroup_size(64)
fn read_parts(@builtin(global_invocation_id) id: vec3<u32>) {
    let contact = id.x;
    if (contact == 0u) {
        atomicAdd(&status[SUM_ROUND], 1u);
    }
    if (contact >= contact_count() || word(plan.same + contact) == NONE) {
        return;
    }
    let to = contact * REMEMBERED;
    for (var i = REMEMBERED_DRAG_SUM; i < REMEMBERED; i++) {
        fresh[to + i] = of_contact(i, contact);
    }
}

// Those that ended, behind all others.
@compute @workgroup_size(64)
fn place_ended(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = id.x;
    if (i == 0u && runs_on()) {
        let ended = word(plan.ended + plan.worlds * plan.remembered);
        atomicStore(&status[ENDED], ended);
        if (contact_count() + ended > plan.contacts) {
            stop(MORE_CONTACTS);
        }
    }
    if (i >= plan.worlds * plan.remembered) {
        return;
    }
    let before = word(plan.ended + i);
    let contact = contact_count() + before;
    if (word(plan.ended + i + 1u) == before || contact >= plan.contacts) {
        return;
    }
    let to = contact * REMEMBERED;
    for (var x = 0u; x < REMEMBERED; x++) {
        let stays = x < REMEMBERED_DRAG || (x >= REMEMBERED_DRAG_SUM);
        fresh[to + x] = select(0.0, remembered_number(i, x), stays);
    }
    for (var p = 0u; p < POINTS; p++) {
        fresh[to + REMEMBERED_POINT + p * REMEMBERED_POINT_WIDTH + 5u] = 0.0;
    }
    put_mark(plan.colour + contact, 0u);
    put(plan.merged + found_before(old_key(i), true) + before, contact);
}

// Where the others come among them.
@compute @workgroup_size(64)
fn merge(@builtin(global_invocation_id) id: vec3<u32>) {
    let contact = id.x;
    if (contact >= contact_count()) {
        return;
    }
    let ended = word(plan.ended + olds_before(key_of(contact)));
    if (contact + ended < plan.contacts) {
        put(plan.merged + contact + ended, contact);
    }
}
