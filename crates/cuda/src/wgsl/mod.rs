//! CUDA C++ of WGSL compute shaders, by way of naga's representation of them.
//!
//! All of a text is one text again: its functions see what is bound, and the variables of their thread, through one
//! structure of pointers, and are inlined where they are called.

mod entries;
mod expressions;
mod names;
mod statements;
#[cfg(test)]
mod tests;
mod types;
mod uses;

pub(crate) use entries::kernel_name;
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga::{
    AddressSpace, Constant, Expression, Function, GlobalVariable, Handle, Module, ScalarKind, Type,
    TypeInner,
};
use names::Names;
use std::cell::RefCell;
use std::collections::{HashMap, HashSet};
use thiserror::Error;
use types::Structure;

/// The operations that CUDA lacks or has other names for.
const PRELUDE: &str = include_str!("prelude.cu");

/// Why a text of WGSL has no CUDA C++.
#[derive(Clone, Debug, Error)]
pub(crate) enum WgslError {
    /// It is none.
    #[error("this is no WGSL: {0}")]
    Parse(String),
    /// It breaks a rule of WGSL.
    #[error("this WGSL is not valid: {0}")]
    Invalid(String),
    /// Something in it is not translated.
    #[error("this of WGSL has no CUDA yet: {0}")]
    Unsupported(String),
}

fn unsupported<T>(what: impl Into<String>) -> Result<T, WgslError> {
    Err(WgslError::Unsupported(what.into()))
}

/// CUDA C++ of a WGSL module.
#[derive(Debug)]
pub(crate) struct Translated {
    pub text: String,
    /// Of each entry point the threads of a block.
    pub threads: HashMap<String, u32>,
    /// How many buffers kernels take, besides the number of blocks.
    pub buffers: usize,
}

/// CUDA C++ of a WGSL module, for NVRTC or nvcc with `--fmad=false`.
///
/// Each entry point NAME becomes a kernel `entry_NAME` for blocks of its workgroup's size. It takes a pointer to each
/// of the buffers of group 0, in the order of their numbers, whether it uses them or not; none may overlap another one
/// that is written, and each begins at a multiple of 16 bytes. A last pointer is null, or to how many blocks do anything at
/// all. What lies beyond the end of a buffer must not be read or written: its length is not known. Arrays of known length
/// are guarded.
///
/// `+`, `-`, `*`, `/`, `sqrt` and `fma` are rounded as on the CPU; sums of products (`dot`, `length`) go from the first
/// component to the last.
pub(crate) fn to_cuda(text: &str) -> Result<Translated, WgslError> {
    let module = naga::front::wgsl::parse_str(text)
        .map_err(|error| WgslError::Parse(error.emit_to_string(text)))?;
    let info = Validator::new(ValidationFlags::all(), Capabilities::empty())
        .validate(&module)
        .map_err(|error| WgslError::Invalid(error.emit_to_string(text)))?;
    let shader = Shader::new(&module, &info);
    let entries = module.entry_points.iter();
    let threads = entries.map(|it| (it.name.clone(), it.workgroup_size.iter().product()));
    Ok(Translated {
        text: shader.print()?,
        threads: threads.collect(),
        buffers: shader.bindings()?.len(),
    })
}

/// A module and the names of what is in it.
struct Shader<'a> {
    module: &'a Module,
    info: &'a ModuleInfo,
    names: Names,
    structures: HashMap<Handle<Type>, Structure>,
    constants: HashMap<Handle<Constant>, String>,
    /// Those constants whose names were asked for.
    used: RefCell<HashSet<Handle<Constant>>>,
    variables: HashMap<Handle<GlobalVariable>, String>,
    functions: HashMap<Handle<Function>, String>,
}

impl<'a> Shader<'a> {
    fn new(module: &'a Module, info: &'a ModuleInfo) -> Self {
        let mut names = Names::new();
        for entry in &module.entry_points {
            names.fresh(&kernel_name(&entry.name));
        }
        let structures = name_structures(module, &mut names);
        let mut name = |wish: Option<&String>| names.fresh(wish.map_or("unnamed", |wish| wish));
        let functions = module.functions.iter();
        let functions = functions.map(|(handle, it)| (handle, name(it.name.as_ref())));
        let functions = functions.collect();
        let variables = module.global_variables.iter();
        let variables = variables.map(|(handle, it)| (handle, name(it.name.as_ref())));
        let variables = variables.collect();
        let constants = module.constants.iter();
        let constants = constants.filter(|(_, it)| is_plain(module, it));
        let constants = constants.map(|(handle, it)| (handle, name(it.name.as_ref())));
        let constants = constants.collect();
        Self {
            module,
            info,
            names,
            structures,
            constants,
            used: RefCell::default(),
            variables,
            functions,
        }
    }

    fn print(&self) -> Result<String, WgslError> {
        if let Some((_, it)) = self.module.overrides.iter().next() {
            let name = it.name.as_deref().unwrap_or("without a name");
            return unsupported(format!("the override {name}"));
        }
        let mut text = format!("{PRELUDE}\nnamespace shader {{\n");
        text.push_str("using wgsl::Array, wgsl::vec2, wgsl::vec3, wgsl::vec4;\n");
        text.push_str("namespace maths = wgsl::maths;\n\n");
        self.print_structures(&mut text)?;
        let mut functions = String::new();
        for (handle, _) in self.module.functions.iter() {
            self.print_function(handle, &mut functions)?;
        }
        for index in 0..self.module.entry_points.len() {
            self.print_entry(index, &mut functions)?;
        }
        self.print_constants(&mut text)?;
        self.print_variables(&mut text)?;
        text += &functions;
        text.push_str("}\n");
        Ok(text)
    }

    fn print_structures(&self, text: &mut String) -> Result<(), WgslError> {
        for (handle, ty) in self.module.types.iter() {
            let TypeInner::Struct { ref members, .. } = ty.inner else {
                continue;
            };
            let structure = self.structure(handle)?;
            *text += &format!("struct {} {{\n", structure.name);
            for (member, name) in members.iter().zip(&structure.members) {
                *text += &format!("    {} {name};\n", self.type_name(member.ty)?);
            }
            *text += "};\n\n";
        }
        Ok(())
    }

    fn print_constants(&self, text: &mut String) -> Result<(), WgslError> {
        for (handle, constant) in self.module.constants.iter() {
            match self.constants.get(&handle) {
                Some(name) if self.used.borrow().contains(&handle) => {
                    let ty = self.type_name(constant.ty)?;
                    let value = self.constant_value(constant.init)?;
                    *text += &format!("constexpr {ty} {name} = {value};\n");
                }
                _ => {}
            }
        }
        text.push('\n');
        Ok(())
    }

    /// What blocks share, and what functions see.
    fn print_variables(&self, text: &mut String) -> Result<(), WgslError> {
        let mut members = String::new();
        for (handle, variable) in self.module.global_variables.iter() {
            let name = self.variable_name(handle)?;
            match variable.space {
                AddressSpace::WorkGroup => {
                    let ty = self.type_name(variable.ty)?;
                    *text += &format!("__shared__ {ty} {name};\n");
                }
                AddressSpace::Private => {
                    members += &format!("    {} {name};\n", self.type_name(variable.ty)?);
                }
                _ => {
                    let member = self.resource(variable)?.member(name);
                    members += &format!("    {member};\n");
                }
            }
        }
        *text += &format!("\nstruct Globals {{\n{members}}};\n\n");
        Ok(())
    }

    fn variable_name(&self, handle: Handle<GlobalVariable>) -> Result<&str, WgslError> {
        let name = self.variables.get(&handle).map(String::as_str);
        name.ok_or_else(|| WgslError::Unsupported("a variable without a name".to_owned()))
    }

    /// A constant by its name, or its value where it has none.
    fn constant(&self, handle: Handle<Constant>) -> Result<String, WgslError> {
        match self.constants.get(&handle) {
            Some(name) => {
                self.used.borrow_mut().insert(handle);
                Ok(name.clone())
            }
            None => self.constant_value(self.module.constants[handle].init),
        }
    }

    /// Of one of the module's own expressions.
    fn constant_value(&self, handle: Handle<Expression>) -> Result<String, WgslError> {
        match self.module.global_expressions[handle] {
            Expression::Literal(literal) => types::literal(literal),
            Expression::Constant(constant) => {
                self.constant_value(self.module.constants[constant].init)
            }
            Expression::ZeroValue(ty) => self.zero(ty),
            Expression::Compose { ty, ref components } => {
                let parts = components.iter().map(|&part| self.constant_value(part));
                let parts: Vec<_> = parts.collect::<Result<_, _>>()?;
                self.composed(ty, &parts)
            }
            Expression::Splat { value, .. } => {
                let ty = self.resolved_name(&self.info[handle])?;
                Ok(format!("{ty}::splat({})", self.constant_value(value)?))
            }
            ref other => unsupported(format!("the constant expression {other:?}")),
        }
    }

    /// A vector, array or structure of parts.
    fn composed(&self, ty: Handle<Type>, parts: &[String]) -> Result<String, WgslError> {
        let (name, parts) = (self.type_name(ty)?, parts.join(", "));
        Ok(match self.module.types[ty].inner {
            TypeInner::Array { .. } => format!("{name}{{{{{parts}}}}}"),
            _ => format!("{name}{{{parts}}}"),
        })
    }
}

/// Scalars have a name in C++, too; others are written out where they are used, and those without a type of their own
/// are not used as they are.
fn is_plain(module: &Module, constant: &Constant) -> bool {
    match module.types[constant.ty].inner {
        TypeInner::Scalar(scalar) => !matches!(
            scalar.kind,
            ScalarKind::AbstractInt | ScalarKind::AbstractFloat
        ),
        _ => false,
    }
}

fn name_structures(module: &Module, names: &mut Names) -> HashMap<Handle<Type>, Structure> {
    let mut structures = HashMap::new();
    for (handle, ty) in module.types.iter() {
        if matches!(ty.inner, TypeInner::Struct { .. }) {
            let name = names.fresh(ty.name.as_deref().unwrap_or("Structure"));
            let members = Vec::new();
            structures.insert(handle, Structure { name, members });
        }
    }
    // No member has the name of a type.
    for (handle, structure) in &mut structures {
        if let TypeInner::Struct { ref members, .. } = module.types[*handle].inner {
            let mut own = names.clone();
            let wishes = members.iter().map(|it| it.name.as_deref());
            let wishes = wishes.map(|name| own.fresh(name.unwrap_or("member")));
            structure.members = wishes.collect();
        }
    }
    structures
}
