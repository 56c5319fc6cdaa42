#pragma once

#include "bot/bot.h"

#include <string>
#include <vector>

namespace lockwind {

/// One JSON object with the fields of the contract and a newline.
std::string bots_json(const std::vector<const Bot*>& bots);
/// A line a bot for a person.
std::string bots_text(const std::vector<const Bot*>& bots);

} // namespace lockwind
