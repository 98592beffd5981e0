# Writes INPUT as a NUL-terminated C array named SYMBOL, and its size, to OUTPUT.
file(READ ${INPUT} hex HEX)
string(REGEX REPLACE "(..)" "0x\\1," bytes "${hex}")
string(REGEX REPLACE "(................................................................................)"
  "\\1\n" bytes "${bytes}")
file(WRITE ${OUTPUT}
  "extern const char ${SYMBOL}[];\nconst char ${SYMBOL}[] = {\n${bytes}0};\n"
  "extern const unsigned long ${SYMBOL}_size;\n"
  "const unsigned long ${SYMBOL}_size = sizeof ${SYMBOL} - 1;\n")
