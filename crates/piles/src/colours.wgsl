// Colours: each contact has the first that none of the contacts before it has, at both of its bodies.

fn carrier(contact: u32, side: u32) -> u32 {
    return carrier_of(u32(fresh[contact * REMEMBERED + REMEMBERED_SHAPES + side]));
}
fn world_of_contact(contact: u32) -> u32 {
    return world_of(u32(fresh[contact * REMEMBERED + REMEMBERED_SHAPES]));
}

fn is_sensed(contact: u32) -> bool {
    return mark(plan.colour + contact) == SENSED;
}

// After it, a body's contacts begin where those of the one before end, and `body_start` says where its own do.
@compute @workgroup_size(64)
fn join(@builtin(global_invocation_id) id: vec3<u32>) {
    let contact = id.x;
    if (contact >= contact_count() || is_sensed(contact)) {
        return;
    }
    for (var side = 0u; side < 2u; side++) {
        let body = carrier(contact, side);
        if (!is_fixed(body)) {
            let at = atomicAdd(&marks[plan.body_start + body], 1u);
            put(plan.body_items + at, contact);
        }
    }
}

// Each takes the colour that those before it leave, as far as theirs are known. Repeated until none changes, which
// leaves what they would get one after the other: the first cannot change, then the second, and so on.
@compute @workgroup_size(64)
fn paint(@builtin(global_invocation_id) id: vec3<u32>) {
    let contact = id.x;
    if (told(SETTLED) != 0u || contact >= contact_count() || !runs_on() || is_sensed(contact)) {
        return;
    }
    var used = vec2(0u, 0u);
    for (var side = 0u; side < 2u; side++) {
        let body = carrier(contact, side);
        if (is_fixed(body)) {
            continue;
        }
        let end = mark(plan.body_start + body);
        for (var i = mark(plan.body_start + body - 1u); i < end; i++) {
            let other = word(plan.body_items + i);
            let colour = mark(plan.colour + other);
            if (other < contact && colour < COLOURS) {
                let bit = 1u << (colour & 31u);
                used |= select(vec2(bit, 0u), vec2(0u, bit), colour > 31u);
            }
        }
    }
    var colour = countTrailingZeros(~used.x);
    if (colour == 32u) {
        colour += countTrailingZeros(~used.y);
    }
    if (mark(plan.colour + contact) != colour) {
        put_mark(plan.colour + contact, colour);
        atomicStore(&status[CHANGED], 1u);
    }
}

@compute @workgroup_size(1)
fn settle() {
    if (told(SETTLED) != 0u || !runs_on()) {
        return;
    }
    atomicAdd(&status[ROUND], 1u);
    atomicMax(&status[ROUNDS], told(ROUND));
    if (told(CHANGED) == 0u) {
        atomicStore(&status[SETTLED], 1u);
    }
    atomicStore(&status[CHANGED], 0u);
}

@compute @workgroup_size(64)
fn plan_colours(@builtin(global_invocation_id) id: vec3<u32>) {
    let colour = id.x;
    if (colour > SENSED) {
        return;
    }
    // Those of other colours may have told by now that more have to be launched.
    let stopped = (told(FLAG) & ~MORE_COLOURS) != 0u;
    if (told(SETTLED) == 0u || stopped) {
        // What is known so far is gone on from; nothing is solved.
        if (colour == 0u && runs_on()) {
            stop(MORE_ROUNDS);
        }
        run(select(CONTACTS_RUN, COLOUR_RUN + colour, colour < COLOURS), 0u, 0u);
        return;
    }
    let first = word(plan.colour_matrix + colour * plan.contact_blocks);
    if (colour == SENSED) {
        run(CONTACTS_RUN, 0u, first);
        return;
    }
    let next = word(plan.colour_matrix + (colour + 1u) * plan.contact_blocks);
    if (colour < COLOURS) {
        run(COLOUR_RUN + colour, first, next - first);
    } else {
        // The processor solves what finds no colour one by one.
        for (var i = first; i < next; i++) {
            stop_in(world_of_contact(word(plan.contact_order + i)), PROCESSOR);
        }
        return;
    }
    if (next > first) {
        atomicMax(&status[COLOURED], colour + 1u);
        if (colour >= told(LAUNCHED)) {
            stop(MORE_COLOURS);
        }
    }
}
