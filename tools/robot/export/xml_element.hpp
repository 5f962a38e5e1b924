// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tinyxml2.h>

#include <string>

namespace dfdyn::tools {

/// An XML element that is open while this object lives. Elements made meanwhile are its children.
class XmlElement {
  public:
    XmlElement(tinyxml2::XMLPrinter& printer, const char* name) : printer_(printer) {
        printer_.OpenElement(name);
    }
    ~XmlElement() { printer_.CloseElement(); }
    XmlElement(const XmlElement&) = delete;
    XmlElement& operator=(const XmlElement&) = delete;

    /// Adds an attribute; before the first child.
    XmlElement& set(const char* name, const std::string& value) {
        printer_.PushAttribute(name, value.c_str());
        return *this;
    }

  private:
    tinyxml2::XMLPrinter& printer_;
};

} // namespace dfdyn::tools
