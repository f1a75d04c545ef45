//! The adapters, one per framework.

mod assertion;
mod aunit;
mod boost;
mod cargo;
mod catch2;
mod cppunit;
mod ctest;
mod doctest;
mod expression;
pub mod foreign;
mod go;
mod gtest;
mod junit;
mod program;
mod pytest;
mod python;
#[cfg(test)]
mod recorded;
mod rostest;
mod sections;
mod session_program;
mod tap;
mod unittest;

use crate::framework::Framework;

type AnyFramework = Box<dyn Framework + Send + Sync>;

/// A type, as suites name it, and its adapter.
type FrameworkType = (&'static str, fn() -> AnyFramework);

const TYPES: &[FrameworkType] = &[
    ("aunit", || Box::new(aunit::AUnit)),
    ("boost", || Box::new(boost::BoostTest)),
    ("cargo", || Box::new(cargo::Cargo::default())),
    ("catch2", || Box::new(catch2::Catch2)),
    ("cppunit", || Box::new(cppunit::CppUnit)),
    ("ctest", || Box::new(ctest::CTest::default())),
    ("doctest", || Box::new(doctest::Doctest)),
    ("go", || Box::new(go::Go)),
    ("gtest", || Box::new(gtest::GoogleTest)),
    ("junit", || Box::new(junit::JUnit)),
    ("launch_testing", || Box::new(unittest::LAUNCH_TESTING)),
    ("program", || Box::new(program::Program)),
    ("pytest", || Box::new(pytest::Pytest)),
    ("rostest", || Box::new(rostest::Rostest)),
    ("tap", || Box::new(tap::Tap)),
    ("unittest", || Box::new(unittest::UNITTEST)),
];

/// The framework of this type.
#[must_use]
pub fn by_name(name: &str) -> Option<(&'static str, AnyFramework)> {
    let (name, make) = TYPES.iter().find(|(known, _)| *known == name)?;
    Some((name, make()))
}

/// How the host is started.
#[must_use]
pub fn usage() -> String {
    let names: Vec<&str> = TYPES.iter().map(|(name, _)| *name).collect();
    format!("usage: rtf-host-framework {} [--check FILE… [-- ARGUMENT…]]", names.join("|"))
}
