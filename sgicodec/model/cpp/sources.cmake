set(MODEL sgicodec/model/cpp)
target_sources(_native PRIVATE ${MODEL}/bind_model.cpp ${MODEL}/context.cpp ${MODEL}/network.cpp
  ${MODEL}/network_portable.cpp)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  target_sources(_native PRIVATE ${MODEL}/network_avx2.cpp ${MODEL}/network_avx512.cpp)
  set_source_files_properties(${MODEL}/network_avx2.cpp PROPERTIES COMPILE_OPTIONS "-mavx2;-mfma")
  set_source_files_properties(${MODEL}/network_avx512.cpp PROPERTIES COMPILE_OPTIONS
    "-mavx512f;-mavx512dq;-mavx512vl;-mavx512bw;-mfma;-mprefer-vector-width=512")
endif()
