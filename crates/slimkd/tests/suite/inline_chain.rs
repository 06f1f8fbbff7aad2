//! SIMD kernels are inlined whole: a function that fell out of the chain would be compiled without the instruction set, and cost half
//! the speed. The compiler does not check that, so this reads the machine code of the program at hand.

use crate::common::{hard_rays, soup};
use slimkd::{BuildOptions, InstructionSet, KdTree, Layout, Preset, Tracer};
use slimkd_util::missing;
use std::collections::BTreeSet;
use std::process::Command;
use std::sync::Arc;

/// Calls that a kernel may make: ends of the program, memory that grows, is moved (through the table of imported functions) or freed.
/// And what is done without vectors: a ray's preparation, the place of a hit among the first ones, the walk of the few rays that vectors do not take.
const ALLOWED: [&str; 16] = [
    "PreparedRay::",
    "decide_exactly",
    "binary_search_by",
    "walk_in_f64",
    "core::panicking",
    "core::slice::index",
    "core::option",
    "core::result",
    "core::ptr::drop_in_place",
    "alloc::",
    "__rust",
    "memcpy",
    "memset",
    "memmove",
    "_DYNAMIC",
    "_Unwind_Resume",
];

#[test]
fn no_kernel_calls_out_of_its_inline_chain() {
    if !cfg!(target_arch = "x86_64") {
        return missing("x86-64", "run it there: kernels' code is looked at on x86-64 alone");
    }
    // So that the kernels are in this program.
    let mesh = Arc::new(soup(50, 1.0, 0.0, 1));
    let rays = hard_rays(&mesh, 70, 1);
    for layout in [Layout::TwoByte, Layout::Dense, Layout::Wide] {
        let options = BuildOptions::from(Preset::Slim).with_layout(layout).with_max_tree(None);
        let tree = KdTree::build(Arc::clone(&mesh), &options).unwrap();
        for &set in InstructionSet::ALL {
            let (mut hits, mut any) = (vec![None; rays.len()], vec![false; rays.len()]);
            tree.batch().instruction_set(set).closest(&rays, &mut hits);
            tree.batch().instruction_set(set).coherent().any(&rays, &mut any);
        }
    }
    let program = std::env::current_exe().unwrap();
    let dump = Command::new("objdump").args(["-d", "--no-show-raw-insn", "--demangle"]).arg(program).output();
    let Ok(dump) = dump else { return missing("objdump", "Debian: apt-get install binutils") };
    assert!(dump.status.success(), "{}", String::from_utf8_lossy(&dump.stderr));
    let text = String::from_utf8_lossy(&dump.stdout);
    let (mut kernel, mut kernels, mut wrong) = (None, 0, BTreeSet::new());
    for line in text.lines() {
        if let Some(name) =
            line.strip_suffix(">:").and_then(|line| line.split_once(" <")).map(|(_, name)| name)
        {
            kernel = (name.contains("level::run_avx512") || name.contains("level::run_avx2")).then_some(name);
            kernels += u32::from(kernel.is_some());
        } else if let Some(name) = kernel
            && let Some((_, target)) = line.split_once("call").and_then(|(_, rest)| rest.split_once('<'))
        {
            let target = target.trim_end_matches('>');
            if !ALLOWED.iter().any(|allowed| target.contains(allowed)) {
                wrong.insert(format!("{name} calls {target}"));
            }
        }
    }
    assert!(kernels >= 16, "only {kernels} kernels found");
    assert!(wrong.is_empty(), "{}", wrong.into_iter().collect::<Vec<_>>().join("\n"));
}
