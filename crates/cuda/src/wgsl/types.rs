//! Types, their zeros, and where their parts lie.

use super::{Shader, WgslError, unsupported};
use naga::proc::TypeResolution;
use naga::{
    AddressSpace, ArraySize, GlobalVariable, Handle, Literal, Scalar, ScalarKind, StorageAccess,
    StructMember, Type, TypeInner, VectorSize,
};
use numbers::trace::finite;

/// A structure's name and those of its members.
#[derive(Debug)]
pub(super) struct Structure {
    pub name: String,
    pub members: Vec<String>,
}

/// Bytes of something, and of what its address is a multiple, as C++ has it.
#[derive(Clone, Copy)]
struct Layout {
    size: u32,
    alignment: u32,
}

impl Layout {
    const WORD: Self = Self {
        size: 4,
        alignment: 4,
    };
}

pub(super) fn scalar_name(scalar: Scalar) -> Result<&'static str, WgslError> {
    match (scalar.kind, scalar.width) {
        (ScalarKind::Float, 4) => Ok("f32"),
        (ScalarKind::Uint, 4) => Ok("u32"),
        (ScalarKind::Sint, 4) => Ok("i32"),
        (ScalarKind::Bool, _) => Ok("bool"),
        (kind, width) => unsupported(format!("a {kind:?} of {width} bytes")),
    }
}

/// The scalar of which a value, or what a pointer leads to, consists.
pub(super) fn scalar_of(inner: &TypeInner) -> Option<Scalar> {
    match *inner {
        TypeInner::Scalar(scalar) | TypeInner::Vector { scalar, .. } => Some(scalar),
        _ => None,
    }
}

pub(super) fn vector_name(size: VectorSize, scalar: Scalar) -> Result<String, WgslError> {
    Ok(format!("vec{}<{}>", size as u8, scalar_name(scalar)?))
}

/// A number, to the bit. It may be negative: then it is in parentheses.
pub(super) fn literal(literal: Literal) -> Result<String, WgslError> {
    match literal {
        Literal::F32(x) => Ok(finite(x)),
        Literal::U32(n) => Ok(format!("{n}u")),
        Literal::I32(i32::MIN) => Ok("(-2147483647 - 1)".to_owned()),
        Literal::I32(n @ ..0) => Ok(format!("({n})")),
        Literal::I32(n) => Ok(n.to_string()),
        Literal::Bool(is) => Ok(is.to_string()),
        other => unsupported(format!("the literal {other:?}")),
    }
}

impl Shader<'_> {
    pub(super) fn type_name(&self, ty: Handle<Type>) -> Result<String, WgslError> {
        match self.module.types[ty].inner {
            TypeInner::Struct { .. } => Ok(self.structure(ty)?.name.clone()),
            TypeInner::Array { base, size, .. } => Ok(format!(
                "Array<{}, {}>",
                self.type_name(base)?,
                count(size)?
            )),
            ref inner => inner_name(inner),
        }
    }

    pub(super) fn resolved_name(&self, ty: &TypeResolution) -> Result<String, WgslError> {
        match ty {
            TypeResolution::Handle(ty) => self.type_name(*ty),
            TypeResolution::Value(inner) => inner_name(inner),
        }
    }

    pub(super) fn structure(&self, ty: Handle<Type>) -> Result<&Structure, WgslError> {
        let structure = self.structures.get(&ty);
        structure.ok_or_else(|| WgslError::Unsupported("a structure without a name".to_owned()))
    }

    /// What a variable without a value begins with.
    pub(super) fn zero(&self, ty: Handle<Type>) -> Result<String, WgslError> {
        Ok(match self.module.types[ty].inner {
            TypeInner::Scalar(scalar) | TypeInner::Atomic(scalar) => match scalar_name(scalar)? {
                "f32" => "0.0f".to_owned(),
                "u32" => "0u".to_owned(),
                "i32" => "0".to_owned(),
                _ => "false".to_owned(),
            },
            _ => format!("{}{{}}", self.type_name(ty)?),
        })
    }

    /// What a buffer is to the functions that see it, and what is passed to a kernel for it: where the items of an
    /// array begin that takes all of the buffer, or else a reference.
    pub(super) fn resource(&self, variable: &GlobalVariable) -> Result<Resource, WgslError> {
        let constant = match variable.space {
            AddressSpace::Uniform => true,
            AddressSpace::Storage { access } => !access.contains(StorageAccess::STORE),
            AddressSpace::Handle => {
                return unsupported(kind(&self.module.types[variable.ty].inner));
            }
            other => return unsupported(format!("a variable in the address space {other:?}")),
        };
        let (item, many) = if let TypeInner::Array {
            base,
            size: ArraySize::Dynamic,
            stride,
        } = self.module.types[variable.ty].inner
        {
            self.check_items(base, stride)?;
            (base, true)
        } else {
            self.layout(variable.ty)?;
            (variable.ty, false)
        };
        Ok(Resource {
            item: self.type_name(item)?,
            many,
            constant,
        })
    }

    fn check_items(&self, base: Handle<Type>, stride: u32) -> Result<(), WgslError> {
        let size = self.layout(base)?.size;
        if size == stride {
            return Ok(());
        }
        let name = self.type_name(base)?;
        unsupported(format!(
            "an array in a buffer whose items {name} lie {stride} bytes apart, but take {size} in C++"
        ))
    }

    /// How C++ lays out what is in a buffer; an error if WGSL does otherwise.
    fn layout(&self, ty: Handle<Type>) -> Result<Layout, WgslError> {
        match self.module.types[ty].inner {
            TypeInner::Scalar(Scalar { width: 4, .. })
            | TypeInner::Atomic(Scalar { width: 4, .. }) => Ok(Layout::WORD),
            TypeInner::Vector {
                size,
                scalar: Scalar { width: 4, .. },
            } => Ok(match size {
                VectorSize::Bi => Layout {
                    size: 8,
                    alignment: 8,
                },
                VectorSize::Tri => Layout {
                    size: 12,
                    alignment: 4,
                },
                VectorSize::Quad => Layout {
                    size: 16,
                    alignment: 16,
                },
            }),
            TypeInner::Array { base, size, stride } => {
                self.check_items(base, stride)?;
                let count = count(size)?;
                let alignment = self.layout(base)?.alignment;
                let size = stride.saturating_mul(count);
                Ok(Layout { size, alignment })
            }
            TypeInner::Struct { ref members, span } => self.structure_layout(ty, members, span),
            ref other => unsupported(format!("{} in a buffer", kind(other))),
        }
    }

    fn structure_layout(
        &self,
        ty: Handle<Type>,
        members: &[StructMember],
        span: u32,
    ) -> Result<Layout, WgslError> {
        let mut end = 0_u32;
        let mut alignment = 1;
        for member in members {
            let layout = self.layout(member.ty)?;
            alignment = alignment.max(layout.alignment);
            if end.next_multiple_of(layout.alignment) != member.offset {
                return self.misplaced(ty, member.name.as_deref());
            }
            end = member.offset.saturating_add(layout.size);
        }
        let size = end.next_multiple_of(alignment);
        if size == span {
            Ok(Layout { size, alignment })
        } else {
            self.misplaced(ty, None)
        }
    }

    fn misplaced<T>(&self, ty: Handle<Type>, member: Option<&str>) -> Result<T, WgslError> {
        let name = &self.structure(ty)?.name;
        let what = member.unwrap_or("what comes behind it");
        unsupported(format!(
            "the structure {name} in a buffer: {what} does not lie where C++ has it"
        ))
    }
}

/// What is bound.
pub(super) struct Resource {
    item: String,
    many: bool,
    constant: bool,
}

impl Resource {
    /// As a member of what functions see.
    pub fn member(&self, name: &str) -> String {
        let mark = if self.many { '*' } else { '&' };
        format!("{}{}{mark} {name}", self.qualifier(), self.item)
    }
    /// As what a kernel takes.
    pub fn parameter(&self, name: &str) -> String {
        format!("{}{}* __restrict__ {name}", self.qualifier(), self.item)
    }
    /// What the member is, of what the kernel takes.
    pub fn argument(&self, name: &str) -> String {
        let mark = if self.many { "" } else { "*" };
        format!("{mark}{name}")
    }
    fn qualifier(&self) -> &'static str {
        if self.constant { "const " } else { "" }
    }
}

/// How many items an array has whose number is known.
fn count(size: ArraySize) -> Result<u32, WgslError> {
    match size {
        ArraySize::Constant(count) => Ok(count.get()),
        ArraySize::Pending(_) => unsupported("an array whose length is an override"),
        ArraySize::Dynamic => {
            unsupported("an array of unknown length that is not all of a storage buffer")
        }
    }
}

/// The name of what is no structure and no array.
fn inner_name(inner: &TypeInner) -> Result<String, WgslError> {
    match *inner {
        TypeInner::Scalar(scalar) | TypeInner::Atomic(scalar) => {
            Ok(scalar_name(scalar)?.to_owned())
        }
        TypeInner::Vector { size, scalar } => vector_name(size, scalar),
        ref other => unsupported(kind(other)),
    }
}

/// What kind of thing has no place here.
fn kind(inner: &TypeInner) -> &'static str {
    match inner {
        TypeInner::Matrix { .. } | TypeInner::CooperativeMatrix { .. } => "a matrix",
        TypeInner::Image { .. } => "a texture",
        TypeInner::Sampler { .. } => "a sampler",
        TypeInner::Pointer { .. } | TypeInner::ValuePointer { .. } => "a pointer as a value",
        TypeInner::BindingArray { .. } => "an array of bindings",
        TypeInner::Array { .. } => "an array of unknown origin",
        TypeInner::Struct { .. } => "a structure of unknown origin",
        TypeInner::Scalar(_) | TypeInner::Vector { .. } | TypeInner::Atomic(_) => {
            "a number of another width"
        }
        _ => "what rays are traced with",
    }
}
