# What Debian asks of the files of its packages; CPack calls this when it has collected them.
set(scripts "${CPACK_POISE_SOURCES}/cmake/package")
foreach(component package IN ZIP_LISTS CPACK_COMPONENTS_ALL CPACK_POISE_PACKAGES)
  set(usr "${CPACK_TEMPORARY_DIRECTORY}/${component}/usr")
  set(doc "${usr}/share/doc/${package}")
  file(MAKE_DIRECTORY "${doc}")
  execute_process(COMMAND /usr/bin/python3 -B "${scripts}/licences.py" "${component}" OUTPUT_FILE "${doc}/copyright"
    COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND /usr/bin/python3 -B "${scripts}/debian_changelog.py" "${package}" "${CPACK_PACKAGE_CONTACT}"
    OUTPUT_FILE "${doc}/changelog" COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND /usr/bin/python3 -B "${scripts}/drop_dead_links.py" "${usr}" COMMAND_ERROR_IS_FATAL ANY)
  file(GLOB manuals "${usr}/share/man/man*/*")
  execute_process(COMMAND gzip -9n "${doc}/changelog" ${manuals} COMMAND_ERROR_IS_FATAL ANY)
endforeach()
