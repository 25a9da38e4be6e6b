//! One entry per instruction set around a whole block of work, chosen at run time.
