//! A secret that is compared in constant time.

use std::io::Read;
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};
use subtle::ConstantTimeEq;

/// How many random bytes a token has.
const BYTES: usize = 32;

/// Minimum number of characters of a token in a file.
const SHORTEST: usize = 16;

/// How much of a token's file is read: no token is that long.
const LONGEST: u64 = 64 * 1024;

#[derive(Debug, thiserror::Error)]
pub enum TokenError {
    /// The system has no random bytes.
    #[error("cannot make a token: {0}")]
    Random(getrandom::Error),
    #[error("cannot read the token from `{}`", path.display())]
    Read {
        path: PathBuf,
        #[source]
        source: std::io::Error,
    },
    #[error("the token in `{}` can be read by other users", path.display())]
    Open { path: PathBuf },
    #[error("the token in `{}` is not one line of at least {SHORTEST} visible ASCII characters", path.display())]
    Weak { path: PathBuf },
}

/// A token, or what a session's cookie holds.
pub struct Secret(String);

impl Secret {
    /// A new one.
    ///
    /// # Errors
    /// The system has no random bytes.
    pub fn random() -> Result<Self, TokenError> {
        let mut bytes = [0; BYTES];
        getrandom::fill(&mut bytes).map_err(TokenError::Random)?;
        Ok(Self(bytes.iter().map(|byte| format!("{byte:02x}")).collect()))
    }

    /// The first line of a file.
    ///
    /// # Errors
    /// It cannot be read, or is too short for a token.
    pub fn read(path: &Path) -> Result<Self, TokenError> {
        let failed = |source| TokenError::Read { path: path.to_owned(), source };
        // The same open file is checked and read.
        let file = std::fs::File::open(path).map_err(failed)?;
        if others_may_read(&file.metadata().map_err(failed)?) {
            return Err(TokenError::Open { path: path.to_owned() });
        }
        let text = std::io::read_to_string(file.take(LONGEST)).map_err(failed)?;
        let token = text.strip_suffix('\n').unwrap_or(&text);
        let token = token.strip_suffix('\r').unwrap_or(token);
        if token.len() < SHORTEST || !token.bytes().all(|byte| byte.is_ascii_graphic()) {
            return Err(TokenError::Weak { path: path.to_owned() });
        }
        Ok(Self(token.to_owned()))
    }

    /// Whether this is it. Takes as long for every guess.
    #[must_use]
    pub fn is(&self, guess: &str) -> bool {
        // Hashed, so that the time does not reveal the length either.
        Sha256::digest(&self.0).ct_eq(&Sha256::digest(guess)).into()
    }

    /// The secret itself, to be shown once.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.0
    }
}

/// Whether others than the file's owner can read it. A pipe, as of a shell's
/// `<(…)`, belongs to this process alone.
#[cfg(unix)]
fn others_may_read(file: &std::fs::Metadata) -> bool {
    use std::os::unix::fs::PermissionsExt;
    file.is_file() && file.permissions().mode() & 0o077 != 0
}

#[cfg(not(unix))]
fn others_may_read(_file: &std::fs::Metadata) -> bool {
    false
}

impl std::fmt::Debug for Secret {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Secret(…)")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tokens_differ_and_are_only_what_they_are() {
        let (token, other) = (Secret::random().unwrap(), Secret::random().unwrap());
        assert_eq!(token.text().len(), 2 * BYTES);
        assert!(token.is(token.text()) && !token.is(other.text()));
        assert!(!token.is("") && !token.is(&token.text()[1..]));
        assert_eq!(format!("{token:?}"), "Secret(…)");
    }

    fn private(path: &Path, text: &str) {
        use std::os::unix::fs::PermissionsExt;
        std::fs::write(path, text).unwrap();
        std::fs::set_permissions(path, PermissionsExt::from_mode(0o600)).unwrap();
    }

    #[test]
    fn a_file_that_others_can_read_holds_no_secret() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("token");
        private(&path, "0123456789abcdef");
        assert!(Secret::read(&path).is_ok());
        for mode in [0o640, 0o604, 0o660, 0o644] {
            std::fs::set_permissions(&path, PermissionsExt::from_mode(mode)).unwrap();
            let refused = Secret::read(&path);
            assert!(matches!(refused, Err(TokenError::Open { .. })), "{mode:o}: {refused:?}");
        }
    }

    #[test]
    fn a_token_is_one_long_line() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("token");
        let read = |text: &str| {
            private(&path, text);
            Secret::read(&path).map(|secret| secret.0).map_err(|error| error.to_string())
        };
        assert_eq!(read("0123456789abcdef\n").as_deref(), Ok("0123456789abcdef"));
        for weak in ["", "short\n", "0123456789abcdef\nmore\n", "0123456789abcd f"] {
            assert!(read(weak).is_err_and(|error| error.contains("16 visible")), "{weak}");
        }
    }
}
