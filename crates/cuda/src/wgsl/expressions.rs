//! Values, and what pointers lead to: both are expressions of C++.

use super::statements::Body;
use super::types::{self, scalar_of};
use super::uses::is_vector;
use super::{WgslError, unsupported};
use naga::{
    AddressSpace, BinaryOperator, Expression, Handle, Literal, MathFunction, RelationalFunction,
    Scalar, ScalarKind, SwizzleComponent, Type, TypeInner, UnaryOperator, VectorSize,
};

type Text = Result<String, WgslError>;

impl Body<'_> {
    /// The type of an expression.
    pub(super) fn inner(&self, handle: Handle<Expression>) -> &TypeInner {
        self.info[handle].ty.inner_with(&self.shader.module.types)
    }

    /// The type of what a pointer leads to; of a value, its own. Of a vector's component, that of the scalar.
    pub(super) fn pointee(&self, handle: Handle<Expression>) -> TypeInner {
        match *self.inner(handle) {
            TypeInner::Pointer { base, .. } => self.shader.module.types[base].inner.clone(),
            TypeInner::ValuePointer { size, scalar, .. } => match size {
                Some(size) => TypeInner::Vector { size, scalar },
                None => TypeInner::Scalar(scalar),
            },
            ref value => value.clone(),
        }
    }

    pub(super) fn is_pointer(&self, handle: Handle<Expression>) -> bool {
        let inner = self.inner(handle);
        matches!(
            inner,
            TypeInner::Pointer { .. } | TypeInner::ValuePointer { .. }
        )
    }

    /// Whether a pointer leads to what no kernel changes, and what is always there.
    pub(super) fn is_uniform(&self, handle: Handle<Expression>) -> bool {
        let (TypeInner::Pointer { space, .. } | TypeInner::ValuePointer { space, .. }) =
            self.inner(handle)
        else {
            return false;
        };
        *space == AddressSpace::Uniform
    }

    fn scalar(&self, handle: Handle<Expression>) -> Result<Scalar, WgslError> {
        let scalar = scalar_of(self.inner(handle));
        scalar.ok_or_else(|| WgslError::Unsupported("arithmetic with matrices".to_owned()))
    }

    fn is_vector(&self, handle: Handle<Expression>) -> bool {
        is_vector(self.inner(handle))
    }

    /// An expression that others can be built around.
    pub(super) fn operand(&self, handle: Handle<Expression>) -> Text {
        let text = self.value(handle)?;
        Ok(if is_whole(&text) {
            text
        } else {
            format!("({text})")
        })
    }

    /// By its name where it has one, else written out.
    pub(super) fn value(&self, handle: Handle<Expression>) -> Text {
        match self.known(handle)? {
            Some(name) => Ok(name.to_owned()),
            None => self.written(handle),
        }
    }

    /// Written out: its operands may have names.
    pub(super) fn written(&self, handle: Handle<Expression>) -> Text {
        match self.function.expressions[handle] {
            Expression::Literal(literal) => types::literal(literal),
            Expression::Constant(constant) => self.shader.constant(constant),
            Expression::ZeroValue(ty) => self.shader.zero(ty),
            Expression::Compose { ty, ref components } => self.compose(ty, components),
            Expression::Access { base, index } => self.access(base, index),
            Expression::AccessIndex { base, index } => self.access_index(base, index),
            Expression::Splat { size, value } => {
                let ty = types::vector_name(size, self.scalar(value)?)?;
                Ok(format!("{ty}::splat({})", self.value(value)?))
            }
            Expression::Swizzle {
                size,
                vector,
                pattern,
            } => self.swizzle(size, vector, pattern),
            Expression::FunctionArgument(index) => self.argument(index),
            Expression::GlobalVariable(variable) => {
                let name = self.shader.variable_name(variable)?;
                let space = self.shader.module.global_variables[variable].space;
                Ok(match space {
                    AddressSpace::WorkGroup => name.to_owned(),
                    _ => format!("globals.{name}"),
                })
            }
            Expression::LocalVariable(local) => self.local(local),
            Expression::Load { pointer } => match self.pointee(pointer) {
                TypeInner::Atomic(_) => Ok(format!("maths::load({})", self.value(pointer)?)),
                _ => self.value(pointer),
            },
            Expression::Unary { op, expr } => self.unary(op, expr),
            Expression::Binary { op, left, right } => self.binary(op, left, right),
            Expression::Select {
                condition,
                accept,
                reject,
            } => self.select(condition, accept, reject),
            Expression::Relational { fun, argument } => self.relational(fun, argument),
            Expression::Math {
                fun,
                arg,
                arg1,
                arg2,
                arg3,
            } => self.math(fun, [Some(arg), arg1, arg2, arg3]),
            Expression::As {
                expr,
                kind,
                convert,
            } => self.convert(expr, kind, convert),
            Expression::ArrayLength(_) => unsupported("arrayLength"),
            Expression::Override(_) => unsupported("an override"),
            ref other => unsupported(format!("the expression {other:?}")),
        }
    }

    fn compose(&self, ty: Handle<Type>, components: &[Handle<Expression>]) -> Text {
        let is_vector = matches!(self.shader.module.types[ty].inner, TypeInner::Vector { .. });
        let mut parts = Vec::new();
        for &component in components {
            match *self.inner(component) {
                TypeInner::Vector { size, .. } if is_vector => {
                    let vector = self.operand(component)?;
                    let names = ["x", "y", "z", "w"].into_iter().take(size as usize);
                    parts.extend(names.map(|name| format!("{vector}.{name}")));
                }
                _ => parts.push(self.value(component)?),
            }
        }
        self.shader.composed(ty, &parts)
    }

    fn access(&self, base: Handle<Expression>, index: Handle<Expression>) -> Text {
        let (array, index) = (self.operand(base)?, self.value(index)?);
        Ok(match self.pointee(base) {
            TypeInner::Vector { .. } => format!("{array}.at({index})"),
            _ => format!("{array}[{index}]"),
        })
    }

    fn access_index(&self, base: Handle<Expression>, index: u32) -> Text {
        let whole = self.operand(base)?;
        match self.pointee(base) {
            TypeInner::Vector { .. } => Ok(format!("{whole}.{}", component(index))),
            TypeInner::Array { .. } => Ok(format!("{whole}[{index}]")),
            TypeInner::Struct { .. } => {
                let ty = match *self.inner(base) {
                    TypeInner::Pointer { base, .. } => Some(base),
                    _ => self.info[base].ty.handle(),
                };
                let structure = ty.map(|ty| self.shader.structure(ty)).transpose()?;
                let member = structure.and_then(|it| it.members.get(index as usize));
                match member {
                    Some(member) => Ok(format!("{whole}.{member}")),
                    None => unsupported("a member of a structure without a name"),
                }
            }
            _ => unsupported("columns of matrices"),
        }
    }

    fn swizzle(
        &self,
        size: VectorSize,
        vector: Handle<Expression>,
        pattern: [SwizzleComponent; 4],
    ) -> Text {
        let ty = types::vector_name(size, self.scalar(vector)?)?;
        let vector = self.operand(vector)?;
        let parts = pattern.into_iter().take(size as usize);
        let parts = parts.map(|part| format!("{vector}.{}", component(part as u32)));
        let parts: Vec<_> = parts.collect();
        Ok(format!("{ty}{{{}}}", parts.join(", ")))
    }

    fn unary(&self, op: UnaryOperator, of: Handle<Expression>) -> Text {
        let wraps = op == UnaryOperator::Negate && self.scalar(of)?.kind == ScalarKind::Sint;
        if wraps && !self.is_vector(of) {
            return Ok(format!("maths::negative({})", self.value(of)?));
        }
        let sign = match op {
            UnaryOperator::Negate => '-',
            UnaryOperator::LogicalNot => '!',
            UnaryOperator::BitwiseNot => '~',
        };
        Ok(format!("{sign}{}", self.operand(of)?))
    }

    fn binary(
        &self,
        op: BinaryOperator,
        left: Handle<Expression>,
        right: Handle<Expression>,
    ) -> Text {
        use BinaryOperator as Op;
        let kind = self.scalar(left)?.kind;
        self.scalar(right)?;
        let vectors = self.is_vector(left) || self.is_vector(right);
        let wraps = kind == ScalarKind::Sint && !vectors;
        let called = match op {
            Op::Add if wraps => "sum",
            Op::Subtract if wraps => "difference",
            Op::Multiply if wraps => "product",
            Op::Divide if !self.divides(kind, right) => "quotient",
            Op::Modulo if !self.divides(kind, right) || kind == ScalarKind::Float => "remainder",
            Op::ShiftLeft if wraps || !self.shifts(right) => "shifted_left",
            Op::ShiftRight if !self.shifts(right) => "shifted_right",
            _ => "",
        };
        if !called.is_empty() && !vectors {
            let (left, right) = (self.value(left)?, self.value(right)?);
            return Ok(format!("maths::{called}({left}, {right})"));
        }
        if vectors && matches!(op, Op::ShiftLeft | Op::ShiftRight) {
            let name = if op == Op::ShiftLeft { "left" } else { "right" };
            let (left, right) = (self.value(left)?, self.value(right)?);
            return Ok(format!("maths::shifted_{name}({left}, {right})"));
        }
        let text = format!(
            "{} {} {}",
            self.operand(left)?,
            symbol(op),
            self.operand(right)?
        );
        let bits = matches!(op, Op::And | Op::InclusiveOr | Op::ExclusiveOr);
        Ok(if bits && kind == ScalarKind::Bool && !vectors {
            format!("bool({text})")
        } else {
            text
        })
    }

    /// Whether what is divided by cannot be what WGSL divides by in its own way.
    fn divides(&self, kind: ScalarKind, by: Handle<Expression>) -> bool {
        kind == ScalarKind::Float
            || match self.literal(by) {
                Some(Literal::U32(by)) => by != 0,
                Some(Literal::I32(by)) => by != 0 && by != -1,
                _ => false,
            }
    }

    /// Whether so many bits are fewer than there are.
    fn shifts(&self, by: Handle<Expression>) -> bool {
        matches!(self.literal(by), Some(Literal::U32(..32)))
    }

    /// What is known of a value while this is written.
    fn literal(&self, handle: Handle<Expression>) -> Option<Literal> {
        let module = self.shader.module;
        match self.function.expressions[handle] {
            Expression::Literal(literal) => Some(literal),
            Expression::Constant(constant) => {
                let init = module.constants[constant].init;
                match module.global_expressions[init] {
                    Expression::Literal(literal) => Some(literal),
                    _ => None,
                }
            }
            _ => None,
        }
    }

    fn select(
        &self,
        condition: Handle<Expression>,
        accept: Handle<Expression>,
        reject: Handle<Expression>,
    ) -> Text {
        if self.is_vector(condition) {
            let (accept, reject) = (self.value(accept)?, self.value(reject)?);
            let condition = self.value(condition)?;
            return Ok(format!("maths::select({reject}, {accept}, {condition})"));
        }
        let (accept, reject) = (self.operand(accept)?, self.operand(reject)?);
        Ok(format!(
            "{} ? {accept} : {reject}",
            self.operand(condition)?
        ))
    }

    fn relational(&self, fun: RelationalFunction, of: Handle<Expression>) -> Text {
        let name = match fun {
            RelationalFunction::All => "all",
            RelationalFunction::Any => "any",
            other => return unsupported(format!("the function {other:?}")),
        };
        Ok(format!("maths::{name}({})", self.value(of)?))
    }

    fn math(&self, fun: MathFunction, arguments: [Option<Handle<Expression>>; 4]) -> Text {
        let Some(name) = math_name(fun) else {
            return unsupported(format!("the function {fun:?}"));
        };
        let arguments = arguments.into_iter().flatten();
        let arguments = arguments.map(|argument| self.value(argument));
        let arguments: Vec<_> = arguments.collect::<Result<_, _>>()?;
        Ok(format!("maths::{name}({})", arguments.join(", ")))
    }

    /// To another type of number: of the same value as far as there is one, or of the same bits.
    fn convert(&self, of: Handle<Expression>, kind: ScalarKind, width: Option<u8>) -> Text {
        let source = self.scalar(of)?;
        let to = Scalar {
            kind,
            width: width.unwrap_or(source.width),
        };
        let to = types::scalar_name(to)?;
        if source.kind == kind {
            return self.value(of);
        }
        let is_cast = width.is_some() && source.kind != ScalarKind::Float && !self.is_vector(of);
        let text = self.value(of)?;
        Ok(match width {
            _ if is_cast => format!("{to}({text})"),
            Some(_) => format!("maths::to_{to}({text})"),
            None => format!("maths::as_{to}({text})"),
        })
    }
}

/// Whether a text stays together whatever stands beside it.
fn is_whole(text: &str) -> bool {
    if text.starts_with(['-', '!', '~']) {
        return false;
    }
    let mut depth = 0_i32;
    for c in text.chars() {
        match c {
            '(' | '[' | '{' => depth += 1,
            ')' | ']' | '}' => depth -= 1,
            ' ' if depth == 0 => return false,
            _ => {}
        }
    }
    true
}

fn component(index: u32) -> char {
    match index {
        0 => 'x',
        1 => 'y',
        2 => 'z',
        _ => 'w',
    }
}

fn symbol(op: BinaryOperator) -> &'static str {
    use BinaryOperator as Op;
    match op {
        Op::Add => "+",
        Op::Subtract => "-",
        Op::Multiply => "*",
        Op::Divide => "/",
        Op::Modulo => "%",
        Op::Equal => "==",
        Op::NotEqual => "!=",
        Op::Less => "<",
        Op::LessEqual => "<=",
        Op::Greater => ">",
        Op::GreaterEqual => ">=",
        Op::And => "&",
        Op::ExclusiveOr => "^",
        Op::InclusiveOr => "|",
        Op::LogicalAnd => "&&",
        Op::LogicalOr => "||",
        Op::ShiftLeft => "<<",
        Op::ShiftRight => ">>",
    }
}

/// The prelude's name of what is done to scalars and, component by component, to vectors.
fn math_name(fun: MathFunction) -> Option<&'static str> {
    use MathFunction as Fun;
    Some(match fun {
        Fun::Abs => "abs",
        Fun::Min => "min",
        Fun::Max => "max",
        Fun::Clamp => "clamp",
        Fun::Saturate => "saturate",
        Fun::Ceil => "ceil",
        Fun::Floor => "floor",
        Fun::Round => "round",
        Fun::Fract => "fract",
        Fun::Trunc => "trunc",
        Fun::Dot => "dot",
        Fun::Cross => "cross",
        Fun::Distance => "distance",
        Fun::Length => "length",
        Fun::Normalize => "normalize",
        Fun::Sign => "sign",
        Fun::Fma => "fma",
        Fun::Mix => "mix",
        Fun::Step => "step",
        Fun::Sqrt => "sqrt",
        Fun::InverseSqrt => "inverse_sqrt",
        Fun::CountTrailingZeros => "count_trailing_zeros",
        Fun::CountLeadingZeros => "count_leading_zeros",
        Fun::CountOneBits => "count_one_bits",
        Fun::ReverseBits => "reverse_bits",
        Fun::FirstTrailingBit => "first_trailing_bit",
        Fun::FirstLeadingBit => "first_leading_bit",
        _ => return None,
    })
}
