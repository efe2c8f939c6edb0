# What Debian asks of the files of its packages; CPack calls this when it has collected them.
file(READ "${CPACK_POISE_SOURCES}/LICENSE" licence)
file(READ "${CPACK_POISE_SOURCES}/app/page/vendor/uplot/LICENSE" uplot)
string(TIMESTAMP now "%a, %d %b %Y %H:%M:%S +0000" UTC)
foreach(component package IN ZIP_LISTS CPACK_COMPONENTS_ALL CPACK_POISE_PACKAGES)
  set(usr "${CPACK_TEMPORARY_DIRECTORY}/${component}/usr")
  set(doc "${usr}/share/doc/${package}")
  file(WRITE "${doc}/copyright" "Poise\n\n${licence}\n\nThe pages that Poise writes contain uPlot\n\n${uplot}")
  file(WRITE "${doc}/changelog" "${package} (${CPACK_PACKAGE_VERSION}) unstable; urgency=medium\n\n"
    "  * Poise ${CPACK_PACKAGE_VERSION}.\n\n -- ${CPACK_PACKAGE_CONTACT}  ${now}\n")
  file(GLOB manuals "${usr}/share/man/man*/*")
  execute_process(COMMAND gzip -9n "${doc}/changelog" ${manuals} COMMAND_ERROR_IS_FATAL ANY)
endforeach()
