//! The SDKs that come with `rtf`: modules for the user's interpreters.

use rtf_model::Diagnostic;

use super::program::utf8;
use super::search_scope::SearchScope;

/// The location of the interpreter's module.
#[derive(Debug)]
pub(super) struct Sdk {
    /// The directory in the installation's prefix.
    installed: &'static str,
    /// The directory in the source tree.
    source: &'static str,
    /// A path that exists in that directory.
    marker: &'static str,
    /// The interpreter's variable for module directories.
    variable: &'static str,
    /// Files of a user in the suite's directory that would have the name of the module.
    module_files: &'static [&'static str],
}

/// The Python SDK, with the host of Python plug-ins.
pub(super) static PYTHON_SDK: Sdk = Sdk {
    installed: "share/rtf/python",
    source: "sdk/python",
    marker: "rtf/host",
    variable: "PYTHONPATH",
    module_files: &["rtf.py", "rtf/__init__.py"],
};

/// The Ruby SDK, with the host of Ruby plug-ins.
pub(super) static RUBY_SDK: Sdk = Sdk {
    installed: "share/rtf/ruby/lib",
    source: "sdk/ruby/lib",
    marker: "rtf/host.rb",
    variable: "RUBYLIB",
    // Ruby does not search the working directory.
    module_files: &[],
};

impl Sdk {
    /// Puts the module's directory before the user's ones. If the directory is
    /// missing, the interpreter may still find an installed module.
    pub fn env(&self, scope: &SearchScope<'_>) -> Result<Vec<(String, String)>, Box<Diagnostic>> {
        let found = scope.runner.shipped(&[self.installed], self.source, self.marker);
        let Some(dir) = found else { return Ok(Vec::new()) };
        let mut value = utf8(&dir)?;
        if let Some(user) = scope.variable(self.variable).filter(|user| !user.is_empty()) {
            value.push(if cfg!(windows) { ';' } else { ':' });
            value.push_str(user);
        }
        Ok(vec![(self.variable.to_owned(), value)])
    }

    /// Warns of a module in the suite's directory that tests cannot import: the host imports the
    /// SDK, which has the same name.
    pub fn hidden_module(&self, scope: &SearchScope<'_>) -> Option<Diagnostic> {
        let sdk = scope.runner.shipped(&[self.installed], self.source, self.marker);
        let is_sdk =
            || sdk.and_then(|sdk| sdk.canonicalize().ok()) == scope.dir.canonicalize().ok();
        let mut files = self.module_files.iter().map(|file| scope.dir.join(file));
        let file = files.find(|file| file.is_file()).filter(|_| !is_sdk())?;
        let (module, _) = self.marker.split_once('/')?;
        let message = format!(
            "tests cannot import `{}`: the module `{module}` is that of rtf",
            file.display()
        );
        let hint = "give your module another name, or put the suite into another directory";
        Some(Diagnostic::warning("hidden-module", message).hint(hint))
    }
}
