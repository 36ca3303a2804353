//! One rank: nothing to send, nothing to wait for.

use std::cell::Cell;

use super::{CommError, Communicator, Exposed, Progress, Traffic, check_letters};

/// The communicator of a program that runs alone.
///
/// All operations return at once. Messages of the rank to itself are delivered, so code need not
/// treat this case apart.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Solo;

struct Counted<'a>(&'a Cell<u64>);

impl Progress for Counted<'_> {
    fn poll(&mut self) {
        self.0.set(self.0.get() + 1);
    }
}

impl Communicator for Solo {
    fn rank(&self) -> usize {
        0
    }

    fn size(&self) -> usize {
        1
    }

    fn exchange_some(
        &self,
        send: Vec<(usize, Vec<u8>)>,
    ) -> Result<Vec<(usize, Vec<u8>)>, CommError> {
        check_letters(&send, 1)?;
        Ok(send.into_iter().filter(|(_, bytes)| !bytes.is_empty()).collect())
    }

    fn all_gather(&self, bytes: &[u8]) -> Result<Vec<Vec<u8>>, CommError> {
        Ok(vec![bytes.to_vec()])
    }

    fn overlap(
        &self,
        traffic: Traffic<'_>,
        inner: &mut dyn FnMut(&mut [u8]),
        local: &mut dyn FnMut(&mut dyn Progress),
    ) -> Result<Exposed, CommError> {
        traffic.check(1)?;
        inner(traffic.send);
        let polls = Cell::new(0);
        local(&mut Counted(&polls));
        let sent = traffic.send_parts.iter().filter(|part| !part.bytes.is_empty());
        let mut got = traffic.receive_parts.iter().filter(|part| !part.bytes.is_empty());
        for part in sent {
            let expected = got.next().map_or(0..0, |part| part.bytes.clone());
            if expected.len() != part.bytes.len() {
                let (got, expected) = (part.bytes.len(), expected.len());
                return Err(CommError::WrongLength { rank: 0, got, expected });
            }
            traffic.receive[expected].copy_from_slice(&traffic.send[part.bytes.clone()]);
        }
        match got.next() {
            Some(part) => {
                Err(CommError::WrongLength { rank: 0, got: 0, expected: part.bytes.len() })
            }
            None => Ok(Exposed { polls: polls.get(), ..Exposed::default() }),
        }
    }

    fn sum_u64(&self, _values: &mut [u64]) -> Result<(), CommError> {
        Ok(())
    }

    fn max_f64(&self, _values: &mut [f64]) -> Result<(), CommError> {
        Ok(())
    }
}
