// SPDX-License-Identifier: Apache-2.0
// RTF_PLUGIN(Class): the symbol that the library exports.
#ifndef RTF_DECLARE_HPP
#define RTF_DECLARE_HPP

#include <rtf/internal/Entry.hpp>

// Once in each plug-in's library, outside any namespace. Class has a constructor
// without arguments, and may be qualified with its namespace.
#define RTF_PLUGIN(Class)                                                                          \
    extern "C" RTF_EXPORT const rtf_plugin_table *rtf_plugin(void)                                 \
    {                                                                                              \
        static constexpr rtf_plugin_table table = ::rtf::internal::table_of<Class>(#Class);        \
        return &table;                                                                             \
    }

#endif
