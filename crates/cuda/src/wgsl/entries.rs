//! Functions, and kernels with what they take.

use super::statements::Body;
use super::{Shader, WgslError, unsupported};
use naga::{
    AddressSpace, Binding, BuiltIn, EntryPoint, Function, GlobalVariable, Handle, ShaderStage,
    TypeInner, valid::GlobalUse,
};

/// What an entry point is called as a kernel.
pub(crate) fn kernel_name(entry: &str) -> String {
    format!("entry_{entry}")
}

impl Shader<'_> {
    pub(super) fn print_function(
        &self,
        handle: Handle<Function>,
        text: &mut String,
    ) -> Result<(), WgslError> {
        let function = &self.module.functions[handle];
        let mut body = Body::new(self, function, &self.info[handle]);
        let result = match &function.result {
            Some(result) => self.type_name(result.ty)?,
            None => "void".to_owned(),
        };
        let mut parameters = vec!["Globals& globals".to_owned()];
        for argument in &function.arguments {
            let name = body.name_argument(argument.name.as_deref());
            let inner = &self.module.types[argument.ty].inner;
            parameters.push(match *inner {
                TypeInner::Pointer { base, .. } => format!("{}& {name}", self.type_name(base)?),
                TypeInner::Struct { .. } | TypeInner::Array { .. } => {
                    format!("const {}& {name}", self.type_name(argument.ty)?)
                }
                _ => format!("const {} {name}", self.type_name(argument.ty)?),
            });
        }
        let (name, parameters) = (self.function_name(handle)?, parameters.join(", "));
        *text += &format!("__device__ __forceinline__ {result} {name}({parameters}) {{\n");
        *text += &body.print()?;
        *text += "}\n";
        Ok(())
    }

    pub(super) fn function_name(&self, handle: Handle<Function>) -> Result<&str, WgslError> {
        let name = self.functions.get(&handle).map(String::as_str);
        name.ok_or_else(|| WgslError::Unsupported("a function without a name".to_owned()))
    }

    pub(super) fn print_entry(&self, index: usize, text: &mut String) -> Result<(), WgslError> {
        let entry = &self.module.entry_points[index];
        check(entry)?;
        let mut parameters = Vec::new();
        for (handle, variable) in self.bindings()? {
            let name = self.variable_name(handle)?;
            parameters.push(self.resource(variable)?.parameter(name));
        }
        parameters.push("const u32* __restrict__ blocks".to_owned());
        let threads: u32 = entry.workgroup_size.iter().product();
        let (name, parameters) = (kernel_name(&entry.name), parameters.join(", "));
        *text += &format!(
            "extern \"C\" __global__ void __launch_bounds__({threads}) {name}({parameters}) {{\n"
        );
        *text += "    if (blocks && blockIdx.x >= *blocks) { return; }\n";
        *text += &self.globals()?;
        *text += &self.cleared(index)?;
        let mut body = Body::new(self, &entry.function, self.info.get_entry_point(index));
        for argument in &entry.function.arguments {
            let name = body.name_argument(argument.name.as_deref());
            let ty = self.type_name(argument.ty)?;
            let value = match &argument.binding {
                Some(binding) => built_in(binding, entry.workgroup_size)?,
                None => self.built_ins(argument.ty, entry.workgroup_size)?,
            };
            *text += &format!("    const {ty} {name} = {value};\n");
        }
        *text += &body.print()?;
        *text += "}\n";
        Ok(())
    }

    /// What is bound, in the order of its numbers.
    pub(super) fn bindings(
        &self,
    ) -> Result<Vec<(Handle<GlobalVariable>, &GlobalVariable)>, WgslError> {
        let mut bindings = Vec::new();
        for (handle, variable) in self.module.global_variables.iter() {
            if let Some(at) = variable.binding {
                if at.group != 0 {
                    return unsupported(format!("a binding of group {}", at.group));
                }
                bindings.push((at.binding, handle, variable));
            }
        }
        bindings.sort_by_key(|&(number, ..)| number);
        if bindings.windows(2).any(|pair| pair[0].0 == pair[1].0) {
            return unsupported("several variables of one binding");
        }
        let bindings = bindings.into_iter();
        Ok(bindings
            .map(|(_, handle, variable)| (handle, variable))
            .collect())
    }

    /// What functions see, from what a kernel takes.
    fn globals(&self) -> Result<String, WgslError> {
        let mut members = Vec::new();
        for (handle, variable) in self.module.global_variables.iter() {
            match variable.space {
                AddressSpace::WorkGroup => {}
                AddressSpace::Private => members.push(match variable.init {
                    Some(value) => self.constant_value(value)?,
                    None => self.zero(variable.ty)?,
                }),
                _ => {
                    let name = self.variable_name(handle)?;
                    members.push(self.resource(variable)?.argument(name));
                }
            }
        }
        Ok(format!(
            "    Globals globals = {{{}}};\n",
            members.join(", ")
        ))
    }

    /// What a block shares and the kernel uses is zero when it begins.
    fn cleared(&self, index: usize) -> Result<String, WgslError> {
        let entry = &self.module.entry_points[index];
        let info = self.info.get_entry_point(index);
        let (thread, threads) = (
            linear(entry.workgroup_size),
            entry.workgroup_size.iter().product::<u32>(),
        );
        let mut text = String::new();
        for (handle, variable) in self.module.global_variables.iter() {
            if variable.space == AddressSpace::WorkGroup && info[handle] != GlobalUse::empty() {
                let name = self.variable_name(handle)?;
                text += &format!("    maths::clear({name}, {thread}, {threads}u);\n");
            }
        }
        if !text.is_empty() {
            text += "    __syncthreads();\n";
        }
        Ok(text)
    }

    /// A structure of them.
    fn built_ins(&self, ty: Handle<naga::Type>, size: [u32; 3]) -> Result<String, WgslError> {
        let TypeInner::Struct { ref members, .. } = self.module.types[ty].inner else {
            return unsupported("an argument of an entry point without a binding");
        };
        let mut parts = Vec::new();
        for member in members {
            let Some(binding) = &member.binding else {
                return unsupported("an argument of an entry point without a binding");
            };
            parts.push(built_in(binding, size)?);
        }
        self.composed(ty, &parts)
    }
}

fn check(entry: &EntryPoint) -> Result<(), WgslError> {
    let name = &entry.name;
    if entry.stage != ShaderStage::Compute {
        unsupported(format!(
            "the entry point {name}, which computes nothing but pictures"
        ))
    } else if entry.workgroup_size_overrides.is_some() {
        unsupported(format!(
            "the entry point {name} of a size that is an override"
        ))
    } else if !name.is_ascii() {
        unsupported(format!("the name {name} of an entry point"))
    } else {
        Ok(())
    }
}

/// The number of a thread in its block.
fn linear([x, y, z]: [u32; 3]) -> String {
    let mut text = "threadIdx.x".to_owned();
    if y > 1 {
        text += &format!(" + {x}u * threadIdx.y");
    }
    if z > 1 {
        text += &format!(" + {}u * threadIdx.z", x.saturating_mul(y));
    }
    text
}

fn built_in(binding: &Binding, size: [u32; 3]) -> Result<String, WgslError> {
    let Binding::BuiltIn(built_in) = *binding else {
        return unsupported("an argument of an entry point that is not built in");
    };
    let global = |axis: &str, size: u32| match size {
        1 => format!("blockIdx.{axis}"),
        _ => format!("blockIdx.{axis} * {size}u + threadIdx.{axis}"),
    };
    let all = |name: &str| format!("vec3<u32>{{{name}.x, {name}.y, {name}.z}}");
    let [x, y, z] = size;
    Ok(match built_in {
        BuiltIn::GlobalInvocationId => {
            let (x, y, z) = (global("x", x), global("y", y), global("z", z));
            format!("vec3<u32>{{{x}, {y}, {z}}}")
        }
        BuiltIn::LocalInvocationId => all("threadIdx"),
        BuiltIn::LocalInvocationIndex => linear(size),
        BuiltIn::WorkGroupId => all("blockIdx"),
        BuiltIn::NumWorkGroups => {
            "vec3<u32>{blocks ? *blocks : gridDim.x, gridDim.y, gridDim.z}".to_owned()
        }
        BuiltIn::WorkGroupSize => format!("vec3<u32>{{{x}u, {y}u, {z}u}}"),
        other => return unsupported(format!("the built-in value {other:?}")),
    })
}
