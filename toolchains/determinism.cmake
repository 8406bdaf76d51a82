# The flags that make one source give the same bits on every CPU. Applied to every target of ours;
# tests/rules reads compile_commands.json and fails when a target escaped them.
#   -ffp-contract=off   no fused multiply-add where the source has two roundings
#   -fsigned-char       plain char is unsigned on ARM otherwise
#   EIGEN_DONT_VECTORIZE  NEON packets use fma, SSE packets do not
#   EIGEN_INITIALIZE_MATRICES_BY_ZERO  a vector nobody set is zero, not what the stack held
#   EIGEN_CACHEFRIENDLY_PRODUCT_THRESHOLD=64  products from size 8 would call malloc otherwise
#   -fno-math-errno     sqrt is one instruction, not a call that may set errno
add_compile_options(-ffp-contract=off -fsigned-char -fno-math-errno)
add_compile_definitions(EIGEN_DONT_VECTORIZE EIGEN_CACHEFRIENDLY_PRODUCT_THRESHOLD=64
                        EIGEN_INITIALIZE_MATRICES_BY_ZERO)

add_compile_options(-Wall -Wextra -Wconversion -Wshadow -Werror)

set(CMAKE_CXX_FLAGS_RELEASE "-O2 -DNDEBUG")
set(CMAKE_CXX_FLAGS_DEBUG "-O1 -g")

if(SUREFOOT_SANITIZE)
  add_compile_options(-fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer)
  add_link_options(-fsanitize=address,undefined)
endif()
