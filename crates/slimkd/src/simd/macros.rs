//! What the instruction sets' files would else repeat.

/// A token, and the vectors that it proves the instructions of.
macro_rules! vectors {
    ($token:ident proves $needs:literal; $($vector:ident($($part:ty),*)),*) => {
        #[doc = concat!("Proof of ", $needs, ".")]
        #[derive(Clone, Copy, Debug)]
        pub(crate) struct $token(());

        impl $token {
            /// # Safety
            #[doc = concat!("The processor must have ", $needs, ".")]
            #[inline(always)]
            pub(crate) unsafe fn new() -> Self {
                Self(())
            }
        }

        // A vector of two parts has the lower lanes in the first.
        $(#[derive(Clone, Copy, Debug)]
        pub(crate) struct $vector($($part),*);)*
    };
}
pub(super) use vectors;

/// Operators of vectors that are one expression of intrinsics; the second operand is a vector unless it has a type.
macro_rules! operators {
    (@operand) => { Self };
    (@operand $type:ty) => { $type };
    ($($vector:ident {
        $($trait:ident::$method:ident = |$a:ident $(, $b:ident $(: $type:ty)?)?| $body:expr;)*
    })*) => {
        $($(
            impl std::ops::$trait $($(<$type>)?)? for $vector {
                type Output = Self;
                #[inline(always)]
                fn $method(self $(, $b: operators!(@operand $($type)?))?) -> Self {
                    let $a = self;
                    #[allow(unused_unsafe)] // masks that are plain bits
                    // SAFETY: a vector exists only where a token exists, which proves the instructions.
                    unsafe { $body }
                }
            }
        )*)*
    };
}
pub(super) use operators;

/// Permutes, compression and gathers of processors that have no instructions for them.
macro_rules! through_memory {
    () => {
        #[inline(always)]
        fn permute(self, x: F32, from: U32) -> F32 {
            self.cast_f32(self.permute_u32(self.cast_u32(x), from))
        }
        #[inline(always)]
        fn permute_u32(self, x: U32, from: U32) -> U32 {
            let (x, from): ([u32; WIDTH], [u32; WIDTH]) = (lanes(self, x), lanes(self, from));
            self.load_u32(&from.map(|i| x[i as usize % WIDTH]))
        }
        #[inline(always)]
        fn compress(self, mask: Mask, x: U32, to: &mut [u32]) -> usize {
            let to = &mut to[..WIDTH];
            let (bits, x): (u32, [u32; WIDTH]) = (self.bits(mask), lanes(self, x));
            let mut count = 0;
            for i in 0..WIDTH {
                to[count] = x[i];
                count += (bits >> i & 1) as usize;
            }
            count
        }
        #[inline(always)]
        unsafe fn gather<const SCALE: i32>(self, base: *const u8, index: U32) -> F32 {
            // SAFETY: the caller's promise.
            self.cast_f32(unsafe { self.gather_u32::<SCALE>(base, index) })
        }
        #[inline(always)]
        unsafe fn gather_u32<const SCALE: i32>(self, base: *const u8, index: U32) -> U32 {
            let index: [u32; WIDTH] = lanes(self, index);
            let x: [u32; WIDTH] = std::array::from_fn(|lane| {
                // SAFETY: the caller says that these bytes are readable.
                unsafe { base.add(index[lane] as usize * SCALE as usize).cast::<u32>().read_unaligned() }
            });
            self.load_u32(&x)
        }
    };
}
pub(super) use through_memory;

/// Methods of tokens that are one expression of intrinsics.
macro_rules! methods {
    ($($name:ident($($argument:ident: $type:ty),*) $(-> $result:ty)? = $body:expr;)*) => {
        $(#[inline(always)]
        fn $name(self, $($argument: $type),*) $(-> $result)? {
            // SAFETY: the token proves the instructions; slices were cut to the vector's width.
            unsafe { $body }
        })*
    };
}
pub(super) use methods;
