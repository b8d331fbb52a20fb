//! What shaders may not do, because a driver answers it with work on every frame.

use std::collections::HashMap;
use std::path::Path;

use wgpu::naga;

use naga::valid::{Capabilities, FunctionInfo, ModuleInfo, ValidationFlags, Validator};
use naga::{Block, Expression, Function, Handle, Module, ShaderStage, Statement};

/// Functions that a vertex shader of the module runs and that branch on a condition of uniforms alone.
fn uniform_branches(source: &str) -> Vec<String> {
    let module = naga::front::wgsl::parse_str(source).unwrap();
    let mut validator = Validator::new(ValidationFlags::all(), Capabilities::all());
    let info = validator.validate(&module).unwrap();
    let mut found = Vec::new();
    for (index, entry) in module.entry_points.iter().enumerate() {
        if entry.stage != ShaderStage::Vertex {
            continue;
        }
        let own = (
            entry.name.as_str(),
            &entry.function,
            info.get_entry_point(index),
        );
        for (name, function, info) in with_callees(&module, &info, own) {
            if branches_on_uniforms(&function.body, &Uniformity::new(function, info)) {
                found.push(name.to_owned());
            }
        }
    }
    found.sort();
    found.dedup();
    found
}

type Named<'a> = (&'a str, &'a Function, &'a FunctionInfo);

/// A function and all that it calls, directly or not.
fn with_callees<'a>(module: &'a Module, info: &'a ModuleInfo, own: Named<'a>) -> Vec<Named<'a>> {
    let mut found = vec![own];
    let mut next = 0;
    while next < found.len() {
        for (_, expression) in found[next].1.expressions.iter() {
            if let Expression::CallResult(callee) = *expression {
                let function = &module.functions[callee];
                let name = function.name.as_deref().unwrap();
                if found.iter().all(|&(known, ..)| known != name) {
                    found.push((name, function, &info[callee]));
                }
            }
        }
        next += 1;
    }
    found
}

/// Which expressions of a function depend on uniforms and constants alone.
struct Uniformity<'a> {
    function: &'a Function,
    info: &'a FunctionInfo,
    arguments: HashMap<Handle<Expression>, &'a [Handle<Expression>]>,
}

impl<'a> Uniformity<'a> {
    fn new(function: &'a Function, info: &'a FunctionInfo) -> Self {
        let mut arguments = HashMap::new();
        for_statements(&function.body, &mut |statement| {
            if let Statement::Call {
                arguments: given,
                result: Some(result),
                ..
            } = statement
            {
                arguments.insert(*result, given.as_slice());
            }
        });
        Self {
            function,
            info,
            arguments,
        }
    }

    fn holds(&self, expression: Handle<Expression>) -> bool {
        if self.info[expression]
            .uniformity
            .non_uniform_result
            .is_none()
        {
            return true;
        }
        match self.function.expressions[expression] {
            Expression::Unary { expr, .. } => self.holds(expr),
            Expression::Binary { left, right, .. } => self.holds(left) && self.holds(right),
            // Functions see what they are given and uniforms.
            Expression::CallResult(_) => self.arguments[&expression].iter().all(|&a| self.holds(a)),
            _ => false,
        }
    }
}

fn branches_on_uniforms(body: &Block, uniformity: &Uniformity<'_>) -> bool {
    let mut found = false;
    for_statements(body, &mut |statement| {
        found |= match *statement {
            Statement::If { condition, .. } => uniformity.holds(condition),
            Statement::Switch { selector, .. } => uniformity.holds(selector),
            _ => false,
        };
    });
    found
}

/// Visits every statement, nested ones too.
fn for_statements<'a>(body: &'a Block, visit: &mut impl FnMut(&'a Statement)) {
    for statement in body {
        visit(statement);
        match statement {
            Statement::Block(block) => for_statements(block, visit),
            Statement::If { accept, reject, .. } => {
                for_statements(accept, visit);
                for_statements(reject, visit);
            }
            Statement::Switch { cases, .. } => {
                for case in cases {
                    for_statements(&case.body, visit);
                }
            }
            Statement::Loop {
                body, continuing, ..
            } => {
                for_statements(body, visit);
                for_statements(continuing, visit);
            }
            _ => {}
        }
    }
}

/// Mesa's software driver puts the values of such uniforms into the code: every step of the camera would
/// compile the shader anew.
#[test]
fn no_vertex_shader_branches_on_uniforms_alone() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/render/shaders");
    let common = std::fs::read_to_string(folder.join("common.wgsl")).unwrap();
    let mut seen = 0;
    for entry in std::fs::read_dir(&folder).unwrap() {
        let path = entry.unwrap().path();
        let own = std::fs::read_to_string(&path).unwrap();
        let source = match path.file_name().unwrap().to_str().unwrap() {
            "common.wgsl" => continue,
            // Has nothing of the scene.
            "composite.wgsl" => own,
            _ => format!("{common}\n{own}"),
        };
        assert_eq!(uniform_branches(&source), [""; 0], "{}", path.display());
        seen += 1;
    }
    assert!(seen >= 7, "{seen} shaders");
}

#[test]
fn no_shader_samples_a_texture() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/render/shaders");
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let source = std::fs::read_to_string(&path).unwrap();
        assert!(!source.contains("textureSample"), "{}", path.display());
    }
}

#[test]
fn branches_on_uniforms_are_seen_through_calls_and_operators() {
    let shader = |body: &str| {
        format!(
            "@group(0) @binding(0) var<uniform> flags: vec4<u32>;
             fn has(bit: u32) -> bool {{ return (flags.x & bit) != 0u; }}
             fn inner(part: u32) -> f32 {{ {body} return 0.0; }}
             @vertex fn vs(@location(0) part: u32) -> @builtin(position) vec4<f32> {{
                 return vec4<f32>(inner(part));
             }}"
        )
    };
    for branching in [
        "if has(1u) { return 1.0; }",
        "if !has(1u) && part < 3u { return 1.0; }",
        "if flags.y == 2u { return 1.0; }",
        "switch flags.z { case 1u: { return 1.0; } default: {} }",
    ] {
        assert_eq!(
            uniform_branches(&shader(branching)),
            ["inner"],
            "{branching}"
        );
    }
    for plain in [
        "if part < flags.z { return 1.0; }",
        "return select(0.0, 1.0, has(1u));",
    ] {
        assert_eq!(uniform_branches(&shader(plain)), [""; 0], "{plain}");
    }
}
