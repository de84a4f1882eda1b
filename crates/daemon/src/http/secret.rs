//! Random secrets.

const SECRET_BYTES: usize = 16;

/// A new secret, as hexadecimal digits.
///
/// # Errors
/// Where the system provides no random bytes.
pub fn secret() -> std::io::Result<String> {
    let mut random = [0; SECRET_BYTES];
    getrandom::fill(&mut random)?;
    Ok(random.iter().map(|byte| format!("{byte:02x}")).collect())
}
