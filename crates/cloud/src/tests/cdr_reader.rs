//! A slow CDR reader to test the writer: it derives alignment from positions, not from written
//! padding.

pub struct Reader<'a> {
    payload: &'a [u8],
    at: usize,
}

impl<'a> Reader<'a> {
    pub fn new(message: &'a [u8]) -> Self {
        let (header, payload) = message.split_at(4);
        assert_eq!(header, [0, 1, 0, 0]);
        Self { payload, at: 0 }
    }

    pub fn take(&mut self, count: usize) -> &'a [u8] {
        let bytes = &self.payload[self.at..self.at + count];
        self.at += count;
        bytes
    }

    fn number<const N: usize>(&mut self) -> [u8; N] {
        while !self.at.is_multiple_of(N) {
            assert_eq!(self.take(1), [0]);
        }
        self.take(N).try_into().unwrap()
    }

    pub fn u8(&mut self) -> u8 {
        self.take(1)[0]
    }

    pub fn u32(&mut self) -> u32 {
        u32::from_le_bytes(self.number())
    }

    pub fn f64(&mut self) -> f64 {
        f64::from_le_bytes(self.number())
    }

    pub fn string(&mut self) -> String {
        let length = self.u32() as usize;
        let (last, text) = self.take(length).split_last().unwrap();
        assert_eq!(*last, 0);
        String::from_utf8(text.to_vec()).unwrap()
    }

    /// Seconds, nanoseconds, frame.
    pub fn header(&mut self) -> (u32, u32, String) {
        (self.u32(), self.u32(), self.string())
    }

    pub fn is_done(&self) -> bool {
        self.at == self.payload.len()
    }
}
