//! Names of C++ for those of WGSL.

use std::collections::HashMap;

/// What names of a shader must not be: words of C++ and of CUDA, and what the text around them uses.
const RESERVED: &str = "alignas alignof and and_eq asm assert atomic_cancel atomic_commit atomic_noexcept auto bitand \
    bitor blockDim blockIdx bool break case catch char char16_t char32_t char8_t class co_await co_return co_yield compl \
    concept const const_cast consteval constexpr constinit continue cudaError_t decltype default delete do double \
    dynamic_cast else enum explicit export extern f32 false float for friend goto gridDim i32 i386 if inline int linux \
    long main maths mutable namespace new noexcept not not_eq nullptr operator or or_eq private protected public reflexpr \
    register reinterpret_cast requires return shader shared short signed sizeof static static_assert static_cast struct \
    switch synchronized template this thread_local threadIdx throw true try typedef typeid typename typeof u32 union unix \
    unsigned using virtual void volatile warpSize wchar_t wgsl while xor xor_eq Array Globals globals vec2 vec3 vec4 \
    EOF INFINITY M_PI NAN NDEBUG NULL stderr stdin stdout errno";

/// The names that are taken in a scope.
#[derive(Clone, Debug)]
pub(super) struct Names {
    /// How often each was asked for.
    taken: HashMap<String, u32>,
}

impl Names {
    /// None but those that nothing may have.
    pub fn new() -> Self {
        let taken = RESERVED.split_whitespace();
        Self {
            taken: taken.map(|word| (word.to_owned(), 0)).collect(),
        }
    }

    /// The name that is wished for, or with a number behind it if it is taken.
    pub fn fresh(&mut self, wish: &str) -> String {
        let base = plain(wish);
        let mut name = base.clone();
        while self.taken.contains_key(&name) {
            let number = self.taken.entry(base.clone()).or_default();
            *number += 1;
            name = format!("{base}_{number}");
        }
        self.taken.insert(name.clone(), 0);
        name
    }
}

/// A name without what C++ has no place for, or keeps for itself.
fn plain(wish: &str) -> String {
    let mut name = String::new();
    for c in wish.chars() {
        let c = if c.is_ascii_alphanumeric() { c } else { '_' };
        if c != '_' || !name.ends_with('_') {
            name.push(c);
        }
    }
    let name = name.trim_matches('_');
    if name.starts_with(|c: char| c.is_ascii_alphabetic()) {
        name.to_owned()
    } else {
        format!("x{name}")
    }
}

#[cfg(test)]
mod tests {
    use super::Names;

    #[test]
    fn names_differ_from_each_other_and_from_words() {
        let mut names = Names::new();
        let wishes = ["i", "i", "i_1", "new", "_x", "größe", "a__b", "7", "i"];
        let names: Vec<_> = wishes.iter().map(|wish| names.fresh(wish)).collect();
        let expected = [
            "i", "i_1", "i_1_1", "new_1", "x", "gr_e", "a_b", "x7", "i_2",
        ];
        assert_eq!(names, expected);
    }
}
